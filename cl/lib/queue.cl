// Queues: which slots want which stage.
//
// Dense (CPUs): every stage looks at every slot's tag; a slot that wants something else is a dead lane.
// Compacted (GPUs): each queue is a list of slots, filled with one atomic per work-group and queue.
// Either way `queue_take` gives this work-item's slot or NO_SLOT, and all work-items of a group call `queue_push` together. Where queues are dense a
// work-item may also do all slots of a group, one after another: PoCL would give each work-item of a group copies of what it keeps, the stack of a traversal
// among it (docs/performance.md).

#define NO_SLOT 0xffffffffu
#define NO_QUEUE 0xffffffffu

#include "scene/queue.cl"
