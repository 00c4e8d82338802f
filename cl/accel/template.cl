// What the traversals share. The host includes a traversal once for each shape kind, between definitions of
//   SHAPE              the kind's name: SHAPE_prepare and SHAPE_intersect are called, SHAPE_nearest and SHAPE_occluded defined
//   SHAPE_FIRST        number of its first primitive among those of all kinds
//   SHAPE_COUNT        number of its primitives
//   SHAPE_BUFFER(key)  the array `key` of its encoder
//   SHAPE_PRIMITIVE(i) which primitive is at place i of a leaf's range: i, unless leaves share primitives (lumiere/accel/spatial.py)
// and, where a ray may pass through what it meets, SHAPE_counts (accel/counts.cl).
// A traversal tells VISIT_NODE and VISIT_PRIMITIVES what it tests (accel/visits.cl).

#include "accel/visits.cl"
#include "lib/ray.cl"

#define SHAPE_JOIN_EXPANDED(shape, suffix) shape##suffix
#define SHAPE_JOIN(shape, suffix) SHAPE_JOIN_EXPANDED(shape, suffix)
#define SHAPE_FUNCTION(suffix) SHAPE_JOIN(SHAPE, _##suffix)

#if defined(VISIBILITY) || defined(OPACITY)
#define SHAPE_ACCEPTS(index, t_max) SHAPE_FUNCTION(counts)(scene, index, ray, &prepared, t_max, &candidate)
#else
#define SHAPE_ACCEPTS(index, t_max) true
#endif
