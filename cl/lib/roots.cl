// Where a ray enters and leaves a closed quadric.

#include "lib/ray.cl"

typedef struct {
    float enter;
    float leave;
    float error;  // a root that is not above it may be 0: there the ray begins
} roots_t;

static inline roots_t roots_new(float t0, float t1, float error)
{
    roots_t roots = {fmin(t0, t1), fmax(t0, t1), error};
    return roots;
}

static inline bool roots_meet(float t, const roots_t *roots, float t_max, hit_t *hit)
{
    if (!(t > roots->error && t < t_max))
        return false;
    hit->t = t;
    hit->u = 0.0f;
    hit->v = 0.0f;
    return true;
}

static inline bool roots_first(const roots_t *roots, float t_max, hit_t *hit)
{
    return roots_meet(roots->enter > roots->error ? roots->enter : roots->leave, roots, t_max, hit);
}

// Past the first, where that was the entrance.
static inline bool roots_second(const roots_t *roots, float t_max, hit_t *hit)
{
    return roots->enter > roots->error && roots_meet(roots->leave, roots, t_max, hit);
}
