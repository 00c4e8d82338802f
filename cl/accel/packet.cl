// Sixteen rays that are traced together, a lane of each vector a ray. A layout for packets defines SHAPE_nearest_packet and SHAPE_occluded_packet
// in place of SHAPE_nearest and SHAPE_occluded; accel/each.cl makes them of those for a layout that traces one ray at a time.

#include "lib/ray.cl"

#define PACKET 16u

typedef union {
    float16 all;
    float lane[16];
} packet_floats_t;

typedef struct {
    packet_floats_t ox, oy, oz;  // origins
    packet_floats_t dx, dy, dz;  // directions
    packet_floats_t t_max;       // -1 where there is no ray; what is nearer is met
    packet_floats_t t, u, v;     // of what was met, as in hit_t; t is t_max where nothing was
    uint primitive[16];
    uint met[16];                // was something met?
    uint rays;                   // how many there are
} packet_t;

// A ray that is none meets nothing: all its coordinates are 0.
static inline void packet_set(packet_t *packet, uint lane, const ray_t *ray)
{
    const bool valid = ray_is_valid(ray) && ray->t_max > 0.0f;
    packet->ox.lane[lane] = valid ? ray->o.x : 0.0f;
    packet->oy.lane[lane] = valid ? ray->o.y : 0.0f;
    packet->oz.lane[lane] = valid ? ray->o.z : 0.0f;
    packet->dx.lane[lane] = valid ? ray->d.x : 0.0f;
    packet->dy.lane[lane] = valid ? ray->d.y : 0.0f;
    packet->dz.lane[lane] = valid ? ray->d.z : 0.0f;
    packet->t_max.lane[lane] = packet->t.lane[lane] = valid ? ray->t_max : -1.0f;
    packet->met[lane] = 0u;
}

static inline void packet_set_none(packet_t *packet, uint lane)
{
    const ray_t none = {(float3)(0.0f), (float3)(0.0f), 0.0f};
    packet_set(packet, lane, &none);
}

static inline hit_t packet_hit(const packet_t *packet, uint lane)
{
    const hit_t hit = {packet->t.lane[lane], packet->u.lane[lane], packet->v.lane[lane], packet->primitive[lane]};
    return hit;
}

static inline ray_t packet_ray(const packet_t *packet, uint lane)
{
    ray_t ray;
    ray.o = (float3)(packet->ox.lane[lane], packet->oy.lane[lane], packet->oz.lane[lane]);
    ray.d = (float3)(packet->dx.lane[lane], packet->dy.lane[lane], packet->dz.lane[lane]);
    ray.t_max = packet->t_max.lane[lane];
    return ray;
}
