// Packets for a layout that traces one ray at a time: ray after ray.

#include "accel/packet.cl"
#include "accel/template.cl"

static inline void SHAPE_FUNCTION(nearest_packet)(const scene_t *scene, packet_t *packet)
{
    for (uint lane = 0u; lane < LANES; lane++) {
        const ray_t ray = packet_ray(packet, lane);
        hit_t hit;
        hit.t = packet->t.lane[lane];
        if (ray.t_max > 0.0f && SHAPE_FUNCTION(nearest)(scene, &ray, &hit)) {
            packet->t.lane[lane] = hit.t;
            packet->u.lane[lane] = hit.u;
            packet->v.lane[lane] = hit.v;
            packet->primitive.lane[lane] = hit.primitive;
            packet->met.lane[lane] = -1;
        }
    }
}

static inline void SHAPE_FUNCTION(occluded_packet)(const scene_t *scene, packet_t *packet)
{
    for (uint lane = 0u; lane < LANES; lane++) {
        const ray_t ray = packet_ray(packet, lane);
        if (ray.t_max > 0.0f && !packet->met.lane[lane])
            packet->met.lane[lane] = SHAPE_FUNCTION(occluded)(scene, &ray) ? -1 : 0;
    }
}
