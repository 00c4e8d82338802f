// Queues as a tag on every slot, on CPUs (lib/queue.cl): what the slot of a work-item wants, or what sixteen neighbouring slots want.

#include "lib/lanes.cl"

static inline bool queue_holds(const queues_t *queues, uint queue, uint slot)
{
    return slot < queues->capacity && queues->tags[slot] == queue;
}

// Which of the sixteen slots from `first` on it holds.
static inline int16 queue_holds_lanes(const queues_t *queues, uint queue, uint first)
{
    return load_uint_lanes(queues->tags + first) == queue;
}

static inline bool queue_holds_connect(const queues_t *queues, uint slot)
{
    return slot < queues->capacity && queues->connects[slot] != 0u;
}

static inline uint queue_take(const queues_t *queues, uint queue)
{
    uint slot = (uint)get_global_id(0);
    return queue_holds(queues, queue, slot) ? slot : NO_SLOT;
}

static inline bool queue_is_over(const queues_t *queues, uint queue)
{
    return false;
}

static inline void queue_push(const queues_t *queues, uint queue, uint slot, local uint *scratch)
{
    if (queue != NO_QUEUE)
        queues->tags[slot] = queue;
}

static inline void queue_push_with_connect(const queues_t *queues, uint queue, bool connects, uint slot, local uint *scratch)
{
    queue_push(queues, queue, slot, scratch);
    if (connects)
        queues->connects[slot] = 1u;
}

// Pushes to `queue` those of the sixteen slots that are `taken`.
static inline void queue_push_lanes(const queues_t *queues, int16 taken, uint16 queue, uint first)
{
    store_uint_lanes(queues->tags + first, taken, queue);
}

static inline void queue_push_connect_lanes(const queues_t *queues, int16 connects, uint first)
{
    store_uint_lanes(queues->connects + first, connects, 1u);
}
