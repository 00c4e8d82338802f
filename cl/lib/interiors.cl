// The bodies that a path is inside of, where dielectrics overlap: the one of the highest priority is what it goes through, and a boundary that lies
// inside a body of higher priority is not there (Schmidt & Budge 2002, "Simple Nested Dielectrics in Ray Traced Images").
//
// Bodies are told apart by material, so that walls of one body may be shapes of their own. A path remembers INTERIORS of them; with more, the one that
// it entered first is forgotten. It begins outside of all.

#include "lib/math.cl"
#include "lib/path.cl"

#define INTERIORS 4u

// Numbers of rows of scene->bodies, plus 1, in the order of entering; behind them 0.
typedef struct {
    uint body[INTERIORS];
} interiors_t;

static inline interiors_t interiors_get(const path_t *path, uint slot)
{
    interiors_t interiors = {{path_get_interior_0(path, slot), path_get_interior_1(path, slot), path_get_interior_2(path, slot),
                              path_get_interior_3(path, slot)}};
    return interiors;
}

static inline void interiors_set(const path_t *path, uint slot, const interiors_t *interiors)
{
    path_set_interior_0(path, slot, interiors->body[0]);
    path_set_interior_1(path, slot, interiors->body[1]);
    path_set_interior_2(path, slot, interiors->body[2]);
    path_set_interior_3(path, slot, interiors->body[3]);
}

// The body that is seen: of the highest priority, the latest among equals; 0 outside of all.
static inline uint interiors_top(const scene_t *scene, const interiors_t *interiors)
{
    uint top = 0u, priority = 0u;
    for (uint i = 0u; i < INTERIORS; ++i) {
        uint body = interiors->body[i];
        if (body != 0u && scene->bodies[body - 1u].priority >= priority) {
            top = body;
            priority = scene->bodies[body - 1u].priority;
        }
    }
    return top;
}

static inline void interiors_enter(interiors_t *interiors, uint body)
{
    uint at = 0u;
    while (at < INTERIORS && interiors->body[at] != 0u)
        at++;
    for (uint i = 0u; at == INTERIORS && i + 1u < INTERIORS; ++i)
        interiors->body[i] = interiors->body[i + 1u];
    interiors->body[min(at, INTERIORS - 1u)] = body;
}

// Forgets the latest entering of `body`; false where there is none.
static inline bool interiors_leave(interiors_t *interiors, uint body)
{
    uint at = INTERIORS;
    for (uint i = 0u; i < INTERIORS; ++i)
        at = interiors->body[i] == body ? i : at;
    for (uint i = at; i + 1u < INTERIORS; ++i)
        interiors->body[i] = interiors->body[i + 1u];
    if (at < INTERIORS)
        interiors->body[INTERIORS - 1u] = 0u;
    return at < INTERIORS;
}

// What is left of light that has gone so far through the body that is seen (Beer's law).
static inline float3 interiors_transmittance(const scene_t *scene, const interiors_t *interiors, float way)
{
    uint top = interiors_top(scene, interiors);
    return top == 0u ? (float3)(1.0f) : exp(-way * load3(scene->bodies[top - 1u].absorption));
}

// At the boundary of `body`, met from outside it or from inside: sets `crossed` to where a path that passes will be, and `ior` to the body's index
// over that of what is seen beside it. False where the boundary is not there.
static inline bool interiors_meet(const scene_t *scene, const interiors_t *interiors, uint body, bool from_outside, interiors_t *crossed, float *ior)
{
    uint top = interiors_top(scene, interiors), beside = top;
    *crossed = *interiors;
    bool there;
    if (from_outside) {
        interiors_enter(crossed, body);
        there = top == 0u || scene->bodies[top - 1u].priority <= scene->bodies[body - 1u].priority;
    } else {
        bool known = interiors_leave(crossed, body);
        beside = interiors_top(scene, crossed);
        there = top == body || !known;
    }
    *ior = scene->bodies[body - 1u].ior / (beside != 0u ? scene->bodies[beside - 1u].ior : 1.0f);
    return there;
}
