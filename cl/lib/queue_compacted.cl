// Queues as lists of slots, on GPUs (lib/queue.cl).

// Where a work-item stands among those of its group that want the same: none before it, and how many there are.
typedef struct {
    uint rank;
    uint count;
} place_t;

#define EVERY_BYTE 0x0101010101010101UL
#define LOW_BITS 0x7f7f7f7f7f7f7f7fUL

// A place is found in two steps, among the work-items of a chunk and among the chunks, by functions to be called in this order with a barrier between
// each two: group_wish, group_tally, group_place. Local atomics on one address would be served one after the other.
#define CHUNKS (WORK_GROUP_SIZE / CHUNK)

static inline void group_clear(local uint *tallies)
{
    for (uint i = (uint)get_local_id(0); i < QUEUE_COUNT * CHUNKS; i += WORK_GROUP_SIZE)
        tallies[i] = 0u;
}

static inline void group_wish(uint want, local ulong *wishes)
{
    ((local uchar *)wishes)[get_local_id(0)] = (uchar)want;
}

// The place within the chunk, and its count into the tallies. Eight wishes are compared at once, as the bytes of a word, and counted as bytes.
static inline place_t group_tally(uint want, const local ulong *wishes, local uint *tallies)
{
    uint chunk = (uint)get_local_id(0) / CHUNK, me = (uint)get_local_id(0) % CHUNK;
    ulong mine = (ulong)(want & 255u) * EVERY_BYTE, all = 0UL, before = 0UL;
    for (uint word = 0u; word < CHUNK / 8u; ++word) {
        ulong differs = wishes[chunk * (CHUNK / 8u) + word] ^ mine;
        ulong equal = ~(((differs & LOW_BITS) + LOW_BITS) | differs | LOW_BITS) >> 7;  // 1 in each byte that is the same
        all += equal;
        before += word < me / 8u ? equal : word == me / 8u ? equal & ((1UL << (8u * (me % 8u))) - 1UL) : 0UL;
    }
    place_t place = {(uint)((before * EVERY_BYTE) >> 56), (uint)((all * EVERY_BYTE) >> 56)};
    if (want != NO_QUEUE && place.rank == 0u)
        tallies[want * CHUNKS + chunk] = place.count;
    return place;
}

static inline place_t group_place(uint want, place_t in_chunk, const local uint *tallies)
{
    place_t place = {in_chunk.rank, 0u};
    uint chunk = (uint)get_local_id(0) / CHUNK;
    for (uint other = 0u; want != NO_QUEUE && other < CHUNKS; ++other) {
        uint tally = tallies[want * CHUNKS + other];
        place.count += tally;
        place.rank += other < chunk ? tally : 0u;
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
    local uint *tallies = scratch + SCRATCH_TALLIES;
    group_clear(tallies);
    group_wish(queue, wishes);
    barrier(CLK_LOCAL_MEM_FENCE);
    place_t place = group_tally(queue, wishes, tallies);
    barrier(CLK_LOCAL_MEM_FENCE);
    place = group_place(queue, place, tallies);
    queue_reserve(queues, queue, place, scratch);
    barrier(CLK_LOCAL_MEM_FENCE);
    queue_store(queues, queue, queue == NO_QUEUE ? 0u : scratch[queue] + place.rank, slot);
}

// Pushes to `queue`, and to connect's queue where `connects`.
static inline void queue_push_with_connect(const queues_t *queues, uint queue, bool connects, uint slot, local uint *scratch)
{
    local ulong *wishes = (local ulong *)(scratch + SCRATCH_WISHES), *connect_wishes = wishes + WORK_GROUP_SIZE / 8u;
    local uint *tallies = scratch + SCRATCH_TALLIES;
    uint connect = connects ? QUEUE_CONNECT : NO_QUEUE;
    group_clear(tallies);
    group_wish(queue, wishes);
    group_wish(connect, connect_wishes);
    barrier(CLK_LOCAL_MEM_FENCE);
    place_t place = group_tally(queue, wishes, tallies), connect_place = group_tally(connect, connect_wishes, tallies);
    barrier(CLK_LOCAL_MEM_FENCE);
    place = group_place(queue, place, tallies);
    connect_place = group_place(connect, connect_place, tallies);
    queue_reserve(queues, queue, place, scratch);
    queue_reserve(queues, connect, connect_place, scratch);
    barrier(CLK_LOCAL_MEM_FENCE);
    queue_store(queues, queue, queue == NO_QUEUE ? 0u : scratch[queue] + place.rank, slot);
    queue_store(queues, connect, scratch[QUEUE_CONNECT] + connect_place.rank, slot);
}
