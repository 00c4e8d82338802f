// Embree 4's single-ray calls, rtcIntersect1 and rtcOccluded1, in a loop on every core: the peer of tools/benchmark_rays.py, which compiles it.
//
//     benchmark_embree LIBRARY FOLDER THREADS FLAGS
//
// LIBRARY is an Embree 4 shared library, opened at run time, so that no header of it is needed: what is used is declared here. FOLDER/vertices.f32
// holds triangles, nine floats each; FLAGS are the scene's (0: Embree's fast test; 4: RTC_SCENE_FLAG_ROBUST). First a line is written: the name, and
// after a tab the seconds of the build. Then a line "KIND nearest" or "KIND any" on standard input has the rays in FOLDER/KIND.rays, seven
// floats each (origin, direction, farthest distance), traced, and is answered with the seconds it took; distances, or 0 and 1, are then in
// FOLDER/KIND.out. Threads take rays 1024 at a time, so that none waits for another.

#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { GEOMETRY_TRIANGLE = 0, BUFFER_INDEX = 0, BUFFER_VERTEX = 1, FORMAT_UINT3 = 0x5003, FORMAT_FLOAT3 = 0x9003, PROPERTY_VERSION = 0 };
enum { CHUNK = 1024, FLOATS = 7 };

struct ray {
    float org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar;
    unsigned mask, id, flags;
};

struct hit {
    float ng_x, ng_y, ng_z, u, v;
    unsigned primitive, geometry, instance[8];  // Embree writes one or two of instance, by how it was built
};

struct __attribute__((aligned(16))) ray_hit {
    struct ray ray;
    struct hit hit;
};

static void *(*new_device)(const char *);
static ssize_t (*device_property)(void *, int);
static int (*device_error)(void *);
static void *(*new_scene)(void *);
static void (*set_scene_flags)(void *, int);
static void *(*new_geometry)(void *, int);
static void *(*new_buffer)(void *, int, unsigned, int, size_t, size_t);
static void (*commit_geometry)(void *);
static unsigned (*attach_geometry)(void *, void *);
static void (*commit_scene)(void *);
static void (*intersect1)(void *, struct ray_hit *, void *);
static void (*occluded1)(void *, struct ray *, void *);

static void fail(const char *what)
{
    fprintf(stderr, "benchmark_embree: %s\n", what);
    exit(1);
}

static void load(const char *library)
{
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!handle)
        fail(dlerror());
    struct { const char *name; void *to; } functions[] = {
        {"rtcNewDevice", &new_device}, {"rtcGetDeviceProperty", &device_property}, {"rtcGetDeviceError", &device_error},
        {"rtcNewScene", &new_scene}, {"rtcSetSceneFlags", &set_scene_flags}, {"rtcNewGeometry", &new_geometry},
        {"rtcSetNewGeometryBuffer", &new_buffer}, {"rtcCommitGeometry", &commit_geometry}, {"rtcAttachGeometry", &attach_geometry},
        {"rtcCommitScene", &commit_scene}, {"rtcIntersect1", &intersect1}, {"rtcOccluded1", &occluded1}};
    for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
        void *found = dlsym(handle, functions[i].name);
        if (!found)
            fail(dlerror());
        memcpy(functions[i].to, &found, sizeof found);
    }
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec + 1e-9 * time.tv_nsec;
}

static float *read_floats(const char *folder, const char *name, size_t *count)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END))
        fail(path);
    *count = (size_t)ftell(file) / sizeof(float);
    rewind(file);
    float *values = malloc(*count * sizeof(float));
    if (!values || fread(values, sizeof(float), *count, file) != *count)
        fail(path);
    fclose(file);
    return values;
}

struct work {
    void *scene;
    const float *rays;
    size_t count, next;
    bool any;
    float *out;
};

static void *trace(void *argument)
{
    struct work *work = argument;
    const float *rays = work->rays;
    const size_t n = work->count;
    for (;;) {
        size_t begin = __atomic_fetch_add(&work->next, CHUNK, __ATOMIC_RELAXED);
        if (begin >= n)
            return NULL;
        size_t end = begin + CHUNK < n ? begin + CHUNK : n;
        for (size_t i = begin; i < end; i++) {
            const float *r = rays + FLOATS * i;
            struct ray_hit query = {.ray = {r[0], r[1], r[2], 0.0f, r[3], r[4], r[5], 0.0f, r[6], ~0u, 0u, 0u}};
            if (work->any) {
                occluded1(work->scene, &query.ray, NULL);
                work->out[i] = query.ray.tfar < 0.0f;
            } else {
                query.hit.geometry = query.hit.instance[0] = ~0u;
                intersect1(work->scene, &query, NULL);
                work->out[i] = query.ray.tfar;
            }
        }
    }
}

static double run(struct work *work, int threads)
{
    pthread_t thread[threads];
    work->next = 0;
    double begin = now();
    for (int i = 1; i < threads; i++)
        pthread_create(&thread[i], NULL, trace, work);
    trace(work);
    for (int i = 1; i < threads; i++)
        pthread_join(thread[i], NULL);
    return now() - begin;
}

int main(int argc, char **argv)
{
    if (argc != 5)
        fail("expected LIBRARY FOLDER THREADS FLAGS");
    const char *folder = argv[2];
    const int threads = atoi(argv[3]), flags = atoi(argv[4]);
    load(argv[1]);
    size_t floats;
    float *vertices = read_floats(folder, "vertices.f32", &floats);
    char config[64];
    snprintf(config, sizeof config, "threads=%d", threads);
    void *device = new_device(config);
    void *scene = new_scene(device), *geometry = new_geometry(device, GEOMETRY_TRIANGLE);
    set_scene_flags(scene, flags);
    memcpy(new_buffer(geometry, BUFFER_VERTEX, 0, FORMAT_FLOAT3, 3 * sizeof(float), floats / 3), vertices, floats * sizeof(float));
    unsigned *indices = new_buffer(geometry, BUFFER_INDEX, 0, FORMAT_UINT3, 3 * sizeof(unsigned), floats / 9);
    for (size_t i = 0; i < floats / 3; i++)
        indices[i] = (unsigned)i;
    commit_geometry(geometry);
    attach_geometry(scene, geometry);
    double begin = now();
    commit_scene(scene);
    double seconds = now() - begin;
    if (device_error(device))
        fail("Embree reports an error");
    long version = device_property(device, PROPERTY_VERSION);
    printf("Embree %ld.%ld.%ld%s\t%g\n", version / 10000, version / 100 % 100, version % 100, flags & 4 ? " robust" : "", seconds);
    fflush(stdout);

    char kind[64], how[64];
    while (scanf("%63s %63s", kind, how) == 2) {
        char path[4096];
        snprintf(path, sizeof path, "%s.rays", kind);
        float *rays = read_floats(folder, path, &floats);
        struct work work = {scene, rays, floats / FLOATS, 0, !strcmp(how, "any"), NULL};
        work.out = malloc(work.count * sizeof(float));
        if (!work.out)
            fail("no memory");
        memset(work.out, 1, work.count * sizeof(float));  // touched before it is timed
        seconds = run(&work, threads);
        snprintf(path, sizeof path, "%s/%s.out", folder, kind);
        FILE *file = fopen(path, "wb");
        if (!file || fwrite(work.out, sizeof(float), work.count, file) != work.count || fclose(file))
            fail(path);
        free(rays);
        free(work.out);
        printf("%g\n", seconds);
        fflush(stdout);
    }
    return 0;
}
