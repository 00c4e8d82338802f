// Sixteen rays that are traced together, a lane of each vector a ray. A layout for packets defines SHAPE_nearest_packet and SHAPE_occluded_packet
// in place of SHAPE_nearest and SHAPE_occluded; accel/each.cl makes them of those for a layout that traces one ray at a time.

#include "lib/lanes.cl"
#include "lib/ray.cl"
#include "scene/lanes.cl"

typedef struct {
    each_float_t ox, oy, oz;  // origins
    each_float_t dx, dy, dz;  // directions
    each_float_t t_max;       // -1 where there is no ray; what is nearer is met
    each_float_t t, u, v;     // of what was met, as in hit_t; t is t_max where nothing was
    each_uint_t primitive;
    each_int_t met;           // was something met?
    uint rays;                // how many there are
} packet_t;

// A ray that is not `wanted`, or none, meets nothing: all its coordinates are 0.
static inline void packet_set(packet_t *packet, int16 wanted, const ray_t_lanes *rays)
{
    const int16 valid = wanted & ray_is_valid_lanes(rays) & (rays->t_max > 0.0f);
    packet->ox.all = valid ? rays->o.x : 0.0f;
    packet->oy.all = valid ? rays->o.y : 0.0f;
    packet->oz.all = valid ? rays->o.z : 0.0f;
    packet->dx.all = valid ? rays->d.x : 0.0f;
    packet->dy.all = valid ? rays->d.y : 0.0f;
    packet->dz.all = valid ? rays->d.z : 0.0f;
    packet->t_max.all = packet->t.all = valid ? rays->t_max : -1.0f;
    packet->u.all = packet->v.all = 0.0f;
    packet->primitive.all = 0u;
    packet->met.all = 0;
    packet->rays = count_lanes(wanted);
}

static inline ray_t packet_ray(const packet_t *packet, uint lane)
{
    ray_t ray;
    ray.o = (float3)(packet->ox.lane[lane], packet->oy.lane[lane], packet->oz.lane[lane]);
    ray.d = (float3)(packet->dx.lane[lane], packet->dy.lane[lane], packet->dz.lane[lane]);
    ray.t_max = packet->t_max.lane[lane];
    return ray;
}

static inline hit_t packet_hit(const packet_t *packet, uint lane)
{
    const hit_t hit = {packet->t.lane[lane], packet->u.lane[lane], packet->v.lane[lane], packet->primitive.lane[lane]};
    return hit;
}
