// What rays visit, for a profile's counting run. In any other program COUNT_VISITS is not defined, and nothing of this is compiled.

#ifdef COUNT_VISITS

#define VISIT_NODE(scene) (scene)->visits->nodes += 1u
#define VISIT_PRIMITIVES(scene, count) (scene)->visits->primitives += (count)

// A sum of 64 bits as two words.
static inline void visits_add(global uint *sum, uint value)
{
    if (atomic_add(sum, value) > 0xffffffffu - value)
        atomic_inc(sum + 1);
}

// Adds a ray to the counts of its bounce; there are several copies of those, so that fewer work-groups wait for each other.
static inline void visits_record(global uint *counts, const visits_t *visits, uint bounce)
{
    uint copy = (uint)get_group_id(0) % VISIT_COPIES;
    global uint *at = counts + 6u * (copy * VISIT_BOUNCES + min(bounce, VISIT_BOUNCES - 1u));
    visits_add(at, 1u);
    visits_add(at + 2, visits->nodes);
    visits_add(at + 4, visits->primitives);
}

// Of a ray whose path has scattered `since` times since the surface or camera that the ray comes from.
#define RECORD_VISITS(slot, since) visits_record(visit_counts, &visits, path_get_depth(&path, slot) - (since))

// What the rays of a packet have visited together is shared among them, before each is recorded.
#define SHARE_VISITS(rays) visits.nodes /= max(rays, 1u); visits.primitives /= max(rays, 1u)
#define FORGET_VISITS visits.nodes = visits.primitives = 0u;
#define RECORD_VISITS_OF_LANES(mask, first, since) \
    const each_int_t traced = {mask}; \
    for (uint lane = 0u; lane < LANES; lane++) \
        if (traced.lane[lane]) \
            RECORD_VISITS(first + lane, since)

#else

#define SHARE_VISITS(rays)
#define FORGET_VISITS
#define RECORD_VISITS_OF_LANES(mask, first, since)
#define VISIT_NODE(scene)
#define VISIT_PRIMITIVES(scene, count)
#define RECORD_VISITS(slot, since)

#endif
