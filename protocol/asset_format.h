/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The asset file: geometry, materials, sensors and distances of one prepared asset. Layout: ASSET.md. Little-endian; every
   section starts at a multiple of 64 bytes. The functions here do no file I/O. */
#ifndef PROTOCOL_ASSET_FORMAT_H
#define PROTOCOL_ASSET_FORMAT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ASSET_MAGIC "PLCASSET"
#define ASSET_VERSION 6u
#define ASSET_ALIGN 64u
#define ASSET_NO_TEXTURE UINT32_MAX
#define ASSET_SECOND_MASK 0x1eu /* mask of the bits that may be set in asset_material.second: bits 1 to 4, for textures 1 to 4 */

enum asset_section {
    ASSET_POSITIONS,        /* section of float[3] per vertex: position in metres, Z up, minus header.origin_m */
    ASSET_NORMALS,          /* float[3] per vertex, unit length */
    ASSET_TEXCOORDS,        /* section of float[2] per vertex: texture coordinates; empty: the asset has no textures */
    ASSET_SECOND_TEXCOORDS, /* section of float[2] per vertex; empty: no material uses the second texture coordinates */
    ASSET_COLORS,           /* section of uint8[4] per vertex: linear RGBA; empty: the vertices have no colours */
    ASSET_INDICES,          /* uint32 per corner */
    ASSET_PRIMITIVES,       /* struct asset_primitive */
    ASSET_LEVELS,           /* struct asset_level, finest first */
    ASSET_CLUSTERS,         /* section of struct asset_cluster, ordered by primitive */
    ASSET_MATERIALS,        /* struct asset_material */
    ASSET_TEXTURES,         /* struct asset_texture */
    /* section of RGBA8 texels of all textures, rows from the top; struct asset_texture says where each texture is */
    ASSET_TEXELS,
    ASSET_SENSORS,  /* section of struct asset_sensor, in the order of the asset's rows in the tag list */
    ASSET_GEODESIC, /* section of uint16[block][sensor][vertex of the block]: geodesic distances as codes (asset_distance.h) */
    ASSET_NAMES,    /* section of strings, each ended by a 0 byte */
    ASSET_SECTION_COUNT
};

struct asset_section_entry {
    uint64_t offset, bytes; /* offset of the section from the start of the file, and its size, in bytes */
};

struct asset_header {
    char magic[8];
    uint32_t version, header_bytes;
    uint64_t file_bytes;
    uint64_t checksum; /* XXH3-64 of the file computed with this field set to 0 */
    /* XXH3-64 of all inputs of the file: model bytes, node pattern, units, sensor positions, and the format version of
       plantcast-prep. An asset whose key is unchanged need not be prepared again */
    uint64_t key;
    double origin_m[3];                     /* in the asset frame */
    float bounds_min_m[3], bounds_max_m[3]; /* bounding box of all vertices, relative to origin_m */
    uint32_t vertex_count, index_count, primitive_count, level_count, material_count, texture_count, sensor_count, cluster_count;
    struct asset_section_entry sections[ASSET_SECTION_COUNT];
};

struct asset_primitive {               /* a range of triangles with one material, from one node of the model */
    uint32_t first_index, index_count; /* the primitive's range in section ASSET_INDICES; index_count is a multiple of 3 */
    uint32_t material;
    uint32_t name; /* offset in section ASSET_NAMES of the name of the primitive's node */
};

/* a level of detail: its range of primitives, and its number of vertices. A level's vertices are the first ones of the file */
struct asset_level {
    uint32_t first_primitive, primitive_count, vertex_count;
    /* number of vertices made by subdividing triangles; they come last among the vertices that this level adds to the next coarser one */
    uint32_t added_count;
    float error_m; /* largest distance in metres of the level's surface from that of the finest level; 0 for the finest level */
};

/* Triangles of one primitive that are close together and have similar normals, so that they can be drawn or skipped together. The clusters
   of a primitive are contiguous and cover all its indices. Clusters are in the order of primitives. */
struct asset_cluster {
    uint32_t first_index, index_count; /* the cluster's range in section ASSET_INDICES; index_count is a positive multiple of 3 */
    float low_m[3], high_m[3];         /* bounding box of the cluster's vertices */
    /* normal cone for asset_cluster_turned_away(): axis, and cutoff as in ASSET.md; cutoff 1: the triangles face in all directions */
    float cone_axis[3], cone_cutoff;
};

enum asset_alpha { ASSET_ALPHA_OPAQUE, ASSET_ALPHA_MASK, ASSET_ALPHA_BLEND };

struct asset_material { /* glTF 2.0 metallic-roughness; factors linear */
    float base_color[4];
    float metallic, roughness, normal_scale, occlusion_strength;
    float emissive[3], alpha_cutoff;
    uint32_t base_color_texture, metallic_roughness_texture, normal_texture, occlusion_texture, emissive_texture; /* or ASSET_NO_TEXTURE */
    uint32_t alpha, double_sided, name;
    /* bit n is set if the material's texture n uses the second texture coordinates (n: 0 base colour, 1 metallic-roughness, 2 normal, 3
       occlusion, 4 emissive); bit 0 is never set */
    uint32_t second;
};

struct asset_texture {
    uint64_t offset; /* in ASSET_TEXELS */
    uint32_t width_px, height_px, srgb, wrap_repeat;
};

struct asset_sensor {
    float position_m[3];      /* position of the sensor as configured (X, Y, Z, or that of a model node), relative to header.origin_m */
    float surface_m[3];       /* point of the surface nearest to position_m, relative to header.origin_m */
    float surface_distance_m; /* distance between position_m and surface_m */
    uint32_t nearest_vertex;
    /* Hash (XXH3-64) of the text from which position_m was taken: the name of the model node, or the assumed position. The
       daemon compares it with the plant, to detect that the file is outdated; 0: the position was configured as X, Y, Z. */
    uint64_t node_hash;
};

/* A checked asset file in memory. Its pointers point into the file's bytes, which must outlive the view. */
struct asset_view {
    const struct asset_header *header;
    const float (*positions_m)[3];
    const float (*normals)[3];
    const float (*texcoords)[2];        /* NULL: none */
    const float (*second_texcoords)[2]; /* NULL: none */
    const uint8_t (*colors)[4];         /* NULL: none */
    const uint32_t *indices;
    const struct asset_primitive *primitives;
    const struct asset_level *levels;
    const struct asset_cluster *clusters;
    const struct asset_material *materials;
    const struct asset_texture *textures;
    const uint8_t *texels;
    const struct asset_sensor *sensors;
    const uint16_t *geodesic; /* coded distances (distance_code.h); NULL: the file has none, or they are packed and not unpacked yet */
    /* section of packed distance codes (distance_pack.h), starting with the table of its blocks; NULL: the codes are not packed */
    const uint64_t *packed;
    const char *names;
};

/* Checks an asset file completely (magic, version, size, checksum, section bounds, every index, finiteness) and makes a view.
 * bytes must be aligned to ASSET_ALIGN and outlive the view. Returns false if the file is invalid, with the reason in `why`. */
bool asset_view_init(struct asset_view *view, const void *bytes, size_t size, char why[200]);
/* Like asset_view_init(), but does not check the checksum: for bytes that asset_build() has just made. */
bool asset_view_fresh(struct asset_view *view, const void *bytes, size_t size, char why[200]);
/* Makes view->geodesic usable: unpacks packed distances into memory. *codes receives this memory; NULL if the distances are not
   packed. It must outlive the view; the caller frees it with free(). Takes 3 ns for each vertex and sensor. Returns false if
   out of memory. */
bool asset_view_unpack(struct asset_view *view, uint16_t **codes);

/* Computes the bounding box and the normal cone of a cluster from its triangles. */
void asset_cluster_measure(struct asset_cluster *cluster, const float (*positions_m)[3], const uint32_t *indices);
/* Returns true if an eye at eye_m (relative to header.origin_m) sees all triangles of the cluster only from behind. */
bool asset_cluster_turned_away(const struct asset_cluster *cluster, const float eye_m[3]);

/* Contents of the asset file that asset_build() makes. The caller keeps ownership of all arrays. Zero-initialise. */
struct asset_parts {
    uint64_t key;
    double origin_m[3];
    const float (*positions_m)[3];
    const float (*normals)[3];
    const float (*texcoords)[2];        /* NULL: none */
    const float (*second_texcoords)[2]; /* NULL: none */
    const uint8_t (*colors)[4];         /* NULL: none */
    const uint32_t *indices;
    const struct asset_primitive *primitives;
    const struct asset_level *levels;     /* levels of detail; NULL: the asset has one level, with all primitives */
    const struct asset_cluster *clusters; /* clusters (groups of adjacent triangles); NULL: one cluster for each primitive */
    const struct asset_material *materials;
    const struct asset_texture *textures;
    const uint8_t *texels;
    const struct asset_sensor *sensors;
    const float *geodesic_m; /* [sensor * vertex_count + vertex] */
    /* callback that writes the distance codes directly into the file's section; used in place of geodesic_m */
    void (*write_geodesic)(void *arg, uint16_t *codes);
    /* number of bytes that write_geodesic writes if it writes packed codes; otherwise 0 */
    size_t packed_bytes;
    void *write_arg;
    /* callback that allocates the file's bytes, aligned to ASSET_ALIGN. NULL: aligned_alloc() */
    void *(*make_room)(void *arg, size_t bytes);
    void *room_arg;
    const char *names; /* NULL: one empty name */
    uint32_t vertex_count, index_count, primitive_count, level_count, material_count, texture_count, sensor_count, cluster_count;
    size_t texel_bytes, name_bytes;
};

/* Builds an asset file in memory: lays out the sections and computes bounds and checksum, without checking the contents. Returns the bytes,
   aligned to ASSET_ALIGN; free them with free() unless make_room allocated them. NULL when out of memory. */
void *asset_build(const struct asset_parts *parts, size_t *bytes);

#endif
