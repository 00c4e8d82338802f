// Queues: which slots want which stage.
//
// Dense (CPUs): every stage looks at every slot's tag; a slot that wants something else is a dead lane.
// Compacted (GPUs): each queue is a list of slots, filled with one atomic per work-group and queue.
// Either way `queue_take` gives this work-item's slot or NO_SLOT, and all work-items of a group call `queue_push` together.

#define NO_SLOT 0xffffffffu
#define NO_QUEUE 0xffffffffu

#ifdef QUEUES_COMPACTED

// Where a work-item stands among those of its group that want the same: none before it, and how many there are.
typedef struct {
    uint rank;
    uint count;
} place_t;

#define EVERY_BYTE 0x0101010101010101UL
#define LOW_BITS 0x7f7f7f7f7f7f7f7fUL

static inline void group_wish(uint want, local ulong *wishes)
{
    ((local uchar *)wishes)[get_local_id(0)] = (uchar)want;
}

// To be called between two barriers, the first of which lies behind every work-item's `group_wish`. Eight wishes are compared at once, as the bytes
// of a word; local atomics on one address would be served one after the other.
static inline place_t group_place(uint want, const local ulong *wishes)
{
    uint me = (uint)get_local_id(0);
    ulong mine = (ulong)(want & 255u) * EVERY_BYTE;
    place_t place = {0u, 0u};
    for (uint word = 0u; word < WORK_GROUP_SIZE / 8u; ++word) {
        ulong differs = wishes[word] ^ mine;
        ulong equal = ~(((differs & LOW_BITS) + LOW_BITS) | differs | LOW_BITS);  // the top bit of each byte that is the same
        ulong before = word < me / 8u ? ~0UL : word == me / 8u ? (1UL << (8u * (me % 8u))) - 1UL : 0UL;
        place.count += (uint)popcount(equal);
        place.rank += (uint)popcount(equal & before);
    }
    return place;
}

static inline uint queue_take(const queues_t *queues, uint queue)
{
    uint i = (uint)get_global_id(0);
    return i < queues->counters[queue] ? queues->slots[(size_t)queue * queues->capacity + i] : NO_SLOT;
}

// Does the queue end before this work-group? Then the whole group may leave, ahead of any barrier.
static inline bool queue_is_over(const queues_t *queues, uint queue)
{
#ifdef GROUPS_LEAVE  // not on PoCL 3, whose compiler crashes on a return before a barrier
    return (uint)get_group_id(0) * WORK_GROUP_SIZE >= queues->counters[queue];
#else
    return false;
#endif
}

static inline void queue_store(const queues_t *queues, uint queue, uint at, uint slot)
{
    if (queue != NO_QUEUE)
        queues->slots[(size_t)queue * queues->capacity + at] = slot;
}

// The first of those that want a queue reserves the places of all.
static inline void queue_reserve(const queues_t *queues, uint queue, place_t place, local uint *scratch)
{
    if (queue != NO_QUEUE && place.rank == 0u)
        scratch[queue] = atomic_add(queues->counters + queue, place.count);
}

static inline void queue_push(const queues_t *queues, uint queue, uint slot, local uint *scratch)
{
    local ulong *wishes = (local ulong *)(scratch + SCRATCH_WISHES);
    group_wish(queue, wishes);
    barrier(CLK_LOCAL_MEM_FENCE);
    place_t place = group_place(queue, wishes);
    queue_reserve(queues, queue, place, scratch);
    barrier(CLK_LOCAL_MEM_FENCE);
    queue_store(queues, queue, queue == NO_QUEUE ? 0u : scratch[queue] + place.rank, slot);
}

// Pushes to `queue`, and to connect's queue where `connects`.
static inline void queue_push_with_connect(const queues_t *queues, uint queue, bool connects, uint slot, local uint *scratch)
{
    local ulong *wishes = (local ulong *)(scratch + SCRATCH_WISHES), *connect_wishes = wishes + WORK_GROUP_SIZE / 8u;
    uint connect = connects ? QUEUE_CONNECT : NO_QUEUE;
    group_wish(queue, wishes);
    group_wish(connect, connect_wishes);
    barrier(CLK_LOCAL_MEM_FENCE);
    place_t place = group_place(queue, wishes), connect_place = group_place(connect, connect_wishes);
    queue_reserve(queues, queue, place, scratch);
    queue_reserve(queues, connect, connect_place, scratch);
    barrier(CLK_LOCAL_MEM_FENCE);
    queue_store(queues, queue, queue == NO_QUEUE ? 0u : scratch[queue] + place.rank, slot);
    queue_store(queues, connect, scratch[QUEUE_CONNECT] + connect_place.rank, slot);
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

static inline uint queue_take_connect(const queues_t *queues)
{
    uint slot = (uint)get_global_id(0);
    return slot < queues->capacity && queues->connects[slot] != 0u ? slot : NO_SLOT;
}

#endif
