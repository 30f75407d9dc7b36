/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generates a synthetic facility: one GLB of tanks, pipe runs and flanges, a plant file and a tag list. The same seed gives the same
   files. */
#include <getopt.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/files/atomic_file.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "tests/support/cad.h"

#define FLANGE_AROUND 24
#define FLANGE_ROWS 8
#define SPACING_M 8.0 /* distance in metres between neighbouring assets, which stand on a square grid */

static const char usage[] = "usage: facility --output DIR [--assets N] [--triangles N] [--sensors EVERY] [--seed N]\n"
                            "  --assets N       default 2000\n"
                            "  --triangles N    of all of them, about; default 10000000\n"
                            "  --sensors EVERY  every so many-th asset has two sensors; default 8\n"
                            "  --singles N      instead, N tags: one of each group on each asset in turn. Without flanges\n"
                            "  --seed N         default 1\n"
                            "Writes DIR/facility.glb, DIR/facility.yaml and DIR/facility.csv.\n";

#define GROUPS 5
static const char *const groups[GROUPS] = { "temperature", "pressure", "vibration", "current", "speed" };

struct facility_options {
    const char *folder;
    long assets, triangles, sensors, singles, seed;
};

struct facility {
    struct facility_options options;
    struct cad_random random;
    FILE *bytes; /* temporary file that collects the bytes of the GLB's binary chunk */
    size_t byte_count, triangles;
    long views, accessors, meshes, nodes;
    struct text view_json, accessor_json, mesh_json, node_json, roots, yaml, csv;
    long flange; /* index of the mesh that all flanges share */
};

struct pipe_mesh { /* a tube: rings of vertices along an axis; the last vertex of each ring is joined with the first */
    float (*places)[3], (*normals)[3];
    uint32_t *indices;
    size_t vertices, corners;
};

static void write_bytes(struct facility *f, const void *bytes, size_t count)
{
    if (fwrite(bytes, 1, count, f->bytes) != count) {
        perror("facility");
        exit(1);
    }
    f->byte_count += count;
}

static long add_accessor(struct facility *f, const void *bytes, size_t each, size_t count, int component, const char *type,
                         const char *more)
{
    text_add(&f->view_json, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", f->views ? "," : "", f->byte_count, each * count);
    text_add(&f->accessor_json, "%s{\"bufferView\":%ld,\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"%s}", f->accessors ? "," : "",
             f->views++, component, count, type, more);
    write_bytes(f, bytes, each * count);
    return f->accessors++;
}

static long add_mesh(struct facility *f, const struct pipe_mesh *mesh)
{
    float low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
    for (size_t v = 0; v < mesh->vertices; v++)
        for (int axis = 0; axis < 3; axis++) {
            low[axis] = fminf(low[axis], mesh->places[v][axis]);
            high[axis] = fmaxf(high[axis], mesh->places[v][axis]);
        }
    char *bounds = mem_printf(",\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]", (double)low[0], (double)low[1], (double)low[2],
                              (double)high[0], (double)high[1], (double)high[2]);
    long places = add_accessor(f, mesh->places, 12, mesh->vertices, 5126, "VEC3", bounds);
    long normals = add_accessor(f, mesh->normals, 12, mesh->vertices, 5126, "VEC3", "");
    long indices = add_accessor(f, mesh->indices, 4, mesh->corners, 5125, "SCALAR", "");
    text_add(&f->mesh_json, "%s{\"primitives\":[{\"attributes\":{\"POSITION\":%ld,\"NORMAL\":%ld},\"indices\":%ld,\"material\":0}]}",
             f->meshes ? "," : "", places, normals, indices);
    mem_free(bounds);
    return f->meshes++;
}

/* --- shapes made by sweeping a circle ---------------------------------------------------------------------------------------------- */

/* a ring of a swept shape: its centre, the direction of the axis, a direction in the ring's plane from which its vertices are
   counted, and its radius */
struct pipe_ring {
    double centre[3], along[3], side[3], radius;
};

static void sweep(struct pipe_mesh *mesh, const struct pipe_ring *rings, int rows, int around)
{
    size_t at = 0;
    *mesh = (struct pipe_mesh){ .vertices = (size_t)rows * (size_t)around, .corners = 6 * (size_t)(rows - 1) * (size_t)around };
    mesh->places = mem_array(mesh->vertices, sizeof(*mesh->places));
    mesh->normals = mem_array(mesh->vertices, sizeof(*mesh->normals));
    mesh->indices = mem_array(mesh->corners, sizeof(*mesh->indices));
    for (int r = 0; r < rows; r++)
        for (int a = 0; a < around; a++) {
            const struct pipe_ring *ring = &rings[r];
            const double *n = ring->along, *s = ring->side, angle = 2 * M_PI * a / around;
            const double t[3] = { n[1] * s[2] - n[2] * s[1], n[2] * s[0] - n[0] * s[2], n[0] * s[1] - n[1] * s[0] };
            for (int axis = 0; axis < 3; axis++) {
                double out = cos(angle) * s[axis] + sin(angle) * t[axis];
                mesh->places[r * around + a][axis] = (float)(ring->centre[axis] + ring->radius * out);
                mesh->normals[r * around + a][axis] = (float)out;
            }
        }
    for (int r = 0; r + 1 < rows; r++)
        for (int a = 0; a < around; a++) {
            uint32_t p = (uint32_t)(r * around + a), q = (uint32_t)(r * around + (a + 1) % around), n = (uint32_t)around;
            const uint32_t six[6] = { p, q, p + n, q, q + n, p + n };
            memcpy(mesh->indices + at, six, sizeof(six));
            at += 6;
        }
}

static void mesh_finish(struct pipe_mesh *mesh)
{
    mem_free(mesh->places);
    mem_free(mesh->normals);
    mem_free(mesh->indices);
}

/* Makes a standing tank with round heads. */
static void make_tank(struct pipe_mesh *mesh, int rows, int around, double radius, double height)
{
    struct pipe_ring *rings = mem_array((size_t)rows, sizeof(*rings));
    for (int r = 0; r < rows; r++) {
        double t = (double)r / (rows - 1), head = 0.15, z, out = 1;
        if (t < head) {
            out = sqrt(1 - pow(1 - t / head, 2));
            z = -radius / 2 * (1 - t / head);
        } else if (t > 1 - head) {
            out = sqrt(1 - pow((t - 1 + head) / head, 2));
            z = height + radius / 2 * (t - 1 + head) / head;
        } else {
            z = height * (t - head) / (1 - 2 * head);
        }
        rings[r] = (struct pipe_ring){
            .centre = { 0, 0, z + radius / 2 }, .along = { 0, 0, 1 }, .side = { 1, 0, 0 }, .radius = fmax(radius * out, 1e-3)
        };
    }
    sweep(mesh, rings, rows, around);
    mem_free(rings);
}

/* Makes a pipe run in the plane z = 1 m with quarter bends alternately to the left and to the right. */
static void make_run(struct pipe_mesh *mesh, int rows, int around, double radius, double length)
{
    struct pipe_ring *rings = mem_array((size_t)rows, sizeof(*rings));
    double bend = 4 * radius, straight = length / 4, x = 0, y = 0, heading = 0, step = (length + 2 * M_PI * bend) / (rows - 1), into = 0;
    for (int r = 0, part = 0; r < rows; r++) {
        rings[r] =
            (struct pipe_ring){ .centre = { x, y, 1 }, .along = { cos(heading), sin(heading), 0 }, .side = { 0, 0, 1 }, .radius = radius };
        double long_m = part % 2 ? M_PI / 2 * bend : straight, turn = part % 4 == 1 ? 1 : -1;
        x += step * cos(heading);
        y += step * sin(heading);
        into += step;
        if (part % 2)
            heading += turn * step / bend;
        if (into >= long_m) {
            into -= long_m;
            part++;
        }
    }
    sweep(mesh, rings, rows, around);
    mem_free(rings);
}

/* Makes a flange about the z axis with an outer radius of 1 m and a hole. */
static void make_flange(struct pipe_mesh *mesh)
{
    static const double profile[FLANGE_ROWS][2] = { { 0.6, 0 }, { 0.6, 0.3 }, { 0.7, 0.3 }, { 0.75, 0.2 },
                                                    { 1, 0.2 }, { 1, 0 },     { 0.8, 0 },   { 0.6, 0 } };
    struct pipe_ring rings[FLANGE_ROWS];
    for (int r = 0; r < FLANGE_ROWS; r++)
        rings[r] =
            (struct pipe_ring){ .centre = { 0, 0, profile[r][1] }, .along = { 0, 0, 1 }, .side = { 1, 0, 0 }, .radius = profile[r][0] };
    sweep(mesh, rings, FLANGE_ROWS, FLANGE_AROUND);
}

/* --- assets --------------------------------------------------------------------------------------------------------------------------- */

static void add_node(struct facility *f, const char *json_fmt, ...) __attribute__((format(printf, 2, 3)));
static void add_node(struct facility *f, const char *json_fmt, ...)
{
    va_list ap;
    text_add(&f->node_json, "%s", f->nodes ? "," : "");
    va_start(ap, json_fmt);
    text_add_v(&f->node_json, json_fmt, ap);
    va_end(ap);
    f->nodes++;
}

static void add_sensors(struct facility *f, long asset, const struct pipe_mesh *body, const double at[3])
{
    for (int s = 0; s < 2; s++) {
        const float *p = body->places[(size_t)(cad_random(&f->random) * (double)body->vertices)];
        text_add(&f->csv, "TT-%05ld%c,%ld,Float,plc,temperature,A-%05ld,%.6f,%.6f,%.6f\n", asset, 'A' + s, 400001 + 2 * (2 * asset + s),
                 asset, at[0] + (double)p[0], at[1] + (double)p[1], at[2] + (double)p[2]);
    }
}

/* Assigns tags to assets in turn; each further round uses the next group. */
static void add_singles(struct facility *f, long asset, const struct pipe_mesh *body, const double at[3])
{
    for (long tag = asset, group = 0; tag < f->options.singles; tag += f->options.assets, group++) {
        const float *p = body->places[(size_t)(cad_random(&f->random) * (double)body->vertices)];
        text_add(&f->csv, "T-%05ld,%ld,Float,plc,%s,A-%05ld,%.6f,%.6f,%.6f\n", tag, 400001 + 2 * tag, groups[group % GROUPS], asset,
                 at[0] + (double)p[0], at[1] + (double)p[1], at[2] + (double)p[2]);
    }
}

static void add_asset(struct facility *f, long asset)
{
    const struct facility_options *o = &f->options;
    double share = 0.5 + cad_random(&f->random), radius = 0.2 + 0.5 * cad_random(&f->random), length = 2 + 3 * cad_random(&f->random);
    int flanges = o->singles ? 0 : 2 + (int)(4 * cad_random(&f->random)), flange_triangles = 2 * FLANGE_AROUND * (FLANGE_ROWS - 1);
    double wanted = fmax(share * (double)o->triangles / (double)o->assets - flanges * flange_triangles, 200);
    int around = (int)fmax(sqrt(wanted / 5), 8), rows = (int)fmax(wanted / (2 * around), 4) + 1;
    long across = (long)ceil(sqrt((double)o->assets)), root = f->nodes;
    const double at[3] = { SPACING_M * (double)(asset % across), SPACING_M * (double)(asset / across), 0 };
    struct pipe_mesh body;
    bool tank = asset % 3 == 0;
    if (tank)
        make_tank(&body, rows, around, radius, length);
    else
        make_run(&body, rows, around, radius / 4, length);
    text_add(&f->roots, "%s%ld", root ? "," : "", root);
    struct text children = { 0 };
    for (int c = 0; c <= flanges; c++)
        text_add(&children, "%s%ld", c ? "," : "", root + 1 + c);
    add_node(f, "{\"name\":\"A-%05ld\",\"translation\":[%.9g,%.9g,%.9g],\"children\":[%s]}", asset, at[0], at[1], at[2], children.at);
    add_node(f, "{\"name\":\"A-%05ld body\",\"mesh\":%ld}", asset, add_mesh(f, &body));
    for (int c = 0; c < flanges; c++) /* puts the asset's flanges onto the tank's wall or around the pipe */
        add_node(
            f,
            "{\"name\":\"A-%05ld flange %d\",\"mesh\":%ld,\"translation\":[%.6g,%.6g,%.6g],\"rotation\":[%s],\"scale\":[%.6g,%.6g,%.6g]}",
            asset, c, f->flange, tank ? radius * 0.98 : 0.1 + 0.15 * c, 0.0, tank ? 1 + length * c / 8 : 1.0,
            "0,0.7071067811865475,0,0.7071067811865475", radius / 2.4, radius / 2.4, radius / 4);
    text_add(&f->yaml, "  - { id: A-%05ld, model: facility.glb, nodes: A-%05ld, up: z }\n", asset, asset);
    if (o->singles > 0)
        add_singles(f, asset, &body, at);
    else if (o->sensors > 0 && asset % o->sensors == 0)
        add_sensors(f, asset, &body, at);
    f->triangles += body.corners / 3 + (size_t)(flanges * flange_triangles);
    text_finish(&children);
    mesh_finish(&body);
}

/* --- files ---------------------------------------------------------------------------------------------------------------------------- */

static void must_write(const char *folder, const char *name, const struct text *text)
{
    char *path = mem_printf("%s/%s", folder, name);
    int status = atomic_file_put(path, text->at, text->length);
    if (status != 0) {
        fprintf(stderr, "facility: %s: %s\n", path, strerror(-status));
        exit(1);
    }
    mem_free(path);
}

static void copy_bytes(FILE *from, FILE *to)
{
    char *chunk = mem_array(1 << 20, 1);
    rewind(from);
    for (size_t got; (got = fread(chunk, 1, 1 << 20, from)) > 0;)
        fwrite(chunk, 1, got, to);
    mem_free(chunk);
}

static void write_glb(struct facility *f)
{
    char *path = mem_printf("%s/facility.glb", f->options.folder);
    FILE *out = fopen(path, "wb");
    struct text json = { 0 };
    text_add(&json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"facility\"},\"scene\":0,\"scenes\":[{\"nodes\":[%s]}],", f->roots.at);
    text_add(&json, "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.6,0.62,0.65,1],\"roughnessFactor\":0.5}}],");
    text_add(&json, "\"buffers\":[{\"byteLength\":%zu}],", f->byte_count);
    text_add(&json, "\"nodes\":[%s],\"meshes\":[%s],", f->node_json.at, f->mesh_json.at);
    text_add(&json, "\"accessors\":[%s],\"bufferViews\":[%s]}", f->accessor_json.at, f->view_json.at);
    while (json.length % 4)
        text_add(&json, " ");
    const uint32_t head[5] = { 0x46546c67, 2, (uint32_t)(28 + json.length + f->byte_count), (uint32_t)json.length, 0x4e4f534a };
    const uint32_t chunk[2] = { (uint32_t)f->byte_count, 0x004e4942 };
    if (!out) {
        perror(path);
        exit(1);
    }
    fwrite(head, sizeof(head), 1, out);
    fwrite(json.at, 1, json.length, out);
    fwrite(chunk, sizeof(chunk), 1, out);
    copy_bytes(f->bytes, out);
    if (fclose(out) != 0) {
        perror(path);
        exit(1);
    }
    text_finish(&json);
    mem_free(path);
}

static void facility_finish(struct facility *f)
{
    struct text *const texts[] = { &f->view_json, &f->accessor_json, &f->mesh_json, &f->node_json, &f->roots, &f->yaml, &f->csv };
    for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++)
        text_finish(texts[i]);
    fclose(f->bytes);
}

static bool read_options(int argc, char **argv, struct facility_options *options)
{
    static const struct option known[] = { { "output", required_argument, NULL, 'o' },    { "assets", required_argument, NULL, 'a' },
                                           { "triangles", required_argument, NULL, 't' }, { "sensors", required_argument, NULL, 's' },
                                           { "seed", required_argument, NULL, 'r' },
                                           { "singles", required_argument, NULL, 'i' },   { 0 } };
    int c;
    while ((c = getopt_long(argc, argv, "", known, NULL)) != -1)
        switch (c) {
        case 'o': options->folder = optarg; break;
        case 'a': options->assets = strtol(optarg, NULL, 10); break;
        case 't': options->triangles = strtol(optarg, NULL, 10); break;
        case 's': options->sensors = strtol(optarg, NULL, 10); break;
        case 'i': options->singles = strtol(optarg, NULL, 10); break;
        case 'r': options->seed = strtol(optarg, NULL, 10); break;
        default: return false;
        }
    return options->folder && optind == argc && options->assets > 0 && options->triangles > 0;
}

int main(int argc, char **argv)
{
    struct facility f = { .options = { .assets = 2000, .triangles = 10000000, .sensors = 8, .seed = 1 } };
    struct pipe_mesh flange;
    if (!read_options(argc, argv, &f.options)) {
        fputs(usage, stderr);
        return 2;
    }
    mkdir(f.options.folder, 0777);
    f.random.state = (uint64_t)f.options.seed;
    f.bytes = tmpfile();
    if (!f.bytes) {
        perror("facility");
        return 1;
    }
    text_add(&f.yaml, "# SPDX-License-Identifier: GPL-3.0-or-later\nplant: { name: Synthetic facility }\nassets:\n");
    text_add(&f.csv, "Tag Name,Address,Data Type,Source,Group,Asset,X,Y,Z\n");
    make_flange(&flange);
    f.flange = add_mesh(&f, &flange);
    mesh_finish(&flange);
    for (long asset = 0; asset < f.options.assets; asset++)
        add_asset(&f, asset);
    text_add(&f.yaml, "groups:\n");
    for (int group = 0; group < (f.options.singles ? GROUPS : 1); group++)
        text_add(&f.yaml, "  - { id: %s, unit: K, min: 0, max: 100 }\n", groups[group]);
    text_add(&f.yaml, "sources:\n  - { id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1 }\ntags: facility.csv\n");
    write_glb(&f);
    must_write(f.options.folder, "facility.yaml", &f.yaml);
    must_write(f.options.folder, "facility.csv", &f.csv);
    printf("facility: %ld assets, %zu triangles, %ld nodes, %zu bytes\n", f.options.assets, f.triangles, f.nodes, f.byte_count);
    facility_finish(&f);
    return 0;
}
