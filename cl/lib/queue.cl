// Queues: which slots want which stage.
//
// Dense (CPUs): every stage looks at every slot's tag; a slot that wants something else is a dead lane.
// Compacted (GPUs): each queue is a list of slots, filled with one atomic per work-group and queue.
// Either way `queue_take` gives this work-item's slot or NO_SLOT, and all work-items of a group call `queue_push` together.

#define NO_SLOT 0xffffffffu
#define NO_QUEUE 0xffffffffu

// The next numbers of a counter, one for each work-item that wants one, with one atomic per work-group. All work-items call it.
static inline uint counter_take(global uint *counter, bool wants, local uint *scratch)
{
    if (get_local_id(0) == 0)
        scratch[0] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint rank = 0u;
    if (wants)
        rank = atomic_inc(scratch);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0)
        scratch[1] = scratch[0] > 0u ? atomic_add(counter, scratch[0]) : 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint first = scratch[1];
    barrier(CLK_LOCAL_MEM_FENCE);
    return first + rank;
}

#ifdef QUEUES_COMPACTED

static inline uint queue_take(const queues_t *queues, uint queue)
{
    uint i = (uint)get_global_id(0);
    return i < queues->counters[queue] ? queues->slots[(size_t)queue * queues->capacity + i] : NO_SLOT;
}

static inline void queue_push(const queues_t *queues, uint queue, uint slot, local uint *scratch)
{
    for (uint q = (uint)get_local_id(0); q < QUEUE_COUNT; q += (uint)get_local_size(0))
        scratch[q] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint rank = 0u;
    if (queue != NO_QUEUE)
        rank = atomic_inc(scratch + queue);
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint q = (uint)get_local_id(0); q < QUEUE_COUNT; q += (uint)get_local_size(0))
        if (scratch[q] > 0u)
            scratch[q] = atomic_add(queues->counters + q, scratch[q]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (queue != NO_QUEUE)
        queues->slots[(size_t)queue * queues->capacity + scratch[queue] + rank] = slot;
    barrier(CLK_LOCAL_MEM_FENCE);
}

static inline void queue_push_connect(const queues_t *queues, bool wants, uint slot, local uint *scratch)
{
    queue_push(queues, wants ? QUEUE_CONNECT : NO_QUEUE, slot, scratch);
}

static inline uint queue_take_connect(const queues_t *queues)
{
    return queue_take(queues, QUEUE_CONNECT);
}

#else

static inline uint queue_take(const queues_t *queues, uint queue)
{
    uint slot = (uint)get_global_id(0);
    return slot < queues->capacity && queues->tags[slot] == queue ? slot : NO_SLOT;
}

static inline void queue_push(const queues_t *queues, uint queue, uint slot, local uint *scratch)
{
    if (queue != NO_QUEUE)
        queues->tags[slot] = queue;
}

static inline void queue_push_connect(const queues_t *queues, bool wants, uint slot, local uint *scratch)
{
    if (wants)
        queues->connects[slot] = 1u;
}

static inline uint queue_take_connect(const queues_t *queues)
{
    uint slot = (uint)get_global_id(0);
    return slot < queues->capacity && queues->connects[slot] != 0u ? slot : NO_SLOT;
}

#endif
