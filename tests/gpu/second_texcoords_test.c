/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model whose material uses two sets of texture coordinates, from the GLB file to the drawn frame. The base colour uses the
   first set, and the other four textures use a mirrored mapping. The frame must equal that of a material whose four images are
   mirrored instead. */
#include "tests/support/test.h"

#include <png.h>

#include "render/frame.h"
#include "render/split_view.h"
#include "tests/support/model_maker.h"
#include "tests/support/model_seeds.h"
#include "tests/support/prep_case.h"
#include "tests/support/site.h"
#include "tests/support/rig_case.h"

enum { SIDE = 32, TEXELS = SIDE * SIDE, WIDTH = 320, HEIGHT = 180 };
enum map { BASE, METAL, NORMAL, OCCLUSION, GLOW, MAPS };
/* How the other four textures are mirrored: by a second set of coordinates; by a texture transform that selects this set
   instead of the one that the texture names; by a texture transform of the first set; by mirrored images. BASE_ONLY: there are
   no other textures. */
enum way { SECOND_SET, NAMED_BY_TRANSFORM, TRANSFORMED, MIRRORED_IMAGES, BASE_ONLY, WAYS };
static const char *const way_names[WAYS] = { "second set", "named by transform", "transformed", "mirrored images", "base only" };
static const char PLANT[] = "plant: {name: P, time_zone: UTC}\n"
                            "assets:\n- {id: sheet, model: sheet.glb, up: z}\n"
                            "groups:\n- {id: temperature, quantity: T, unit: C, min: 0, max: 100}\n"
                            "sources:\n- {id: plc, type: modbus, host: 127.0.0.1, byte_order: CDAB, address_base: 1}\n"
                            "tags: tags.csv\n";

/* --- the model ------------------------------------------------------------------------------------------------------------------- */

/* Computes a pixel of a test image. No image equals its mirror image. */
static void paint(enum map map, int column, int row, uint8_t rgb[3])
{
    double x = (column + 0.5) / SIDE, y = (row + 0.5) / SIDE;
    bool inside = hypot(x - 0.3, y - 0.35) < 0.2;
    double slope = inside ? (x - 0.3) / 0.25 : 0;
    switch (map) {
    case BASE: memcpy(rgb, (row / 8 + column / 8) % 2 ? (uint8_t[3]){ 200, 170, 90 } : (uint8_t[3]){ 120, 140, 160 }, 3); break;
    case METAL: memcpy(rgb, (uint8_t[3]){ 0, (uint8_t)(x < 0.5 ? 80 : 230), (uint8_t)(y > 0.7 ? 255 : 0) }, 3); break;
    case NORMAL:
        memcpy(rgb, (uint8_t[3]){ (uint8_t)lrint(127.5 + 120 * slope), 128, (uint8_t)lrint(127.5 + 120 * sqrt(1 - slope * slope)) }, 3);
        break;
    case OCCLUSION: memset(rgb, x > 0.6 && x < 0.9 && y < 0.5 ? 0 : 255, 3); break;
    default: memcpy(rgb, x < 0.25 && y > 0.6 && (x < 0.08 || y > 0.85) ? (uint8_t[3]){ 255, 40, 0 } : (uint8_t[3]){ 0, 0, 0 }, 3); break;
    }
}

static int add_image(struct model_maker *maker, enum map map, bool mirrored)
{
    uint8_t pixels[TEXELS][3], png[8 * TEXELS];
    png_image image = { .version = PNG_IMAGE_VERSION, .width = SIDE, .height = SIDE, .format = PNG_FORMAT_RGB };
    png_alloc_size_t size = sizeof(png);
    for (int i = 0; i < TEXELS; i++) {
        paint(map, mirrored ? SIDE - 1 - i % SIDE : i % SIDE, i / SIDE, pixels[i]);
        if (mirrored && map == NORMAL)
            pixels[i][0] = (uint8_t)(255 - pixels[i][0]);
    }
    if (!png_image_write_to_memory(&image, png, &size, 0, pixels, 0, NULL))
        fail_msg("%s", image.message);
    int view = maker_view(maker, png, size, 0);
    return maker_add(maker, "images", json_pack("{s:i,s:s}", "bufferView", view, "mimeType", "image/png"));
}

static json_t *use_of(struct model_maker *maker, enum map map, enum way way)
{
    bool other = map != BASE;
    int image = add_image(maker, map, other && way == MIRRORED_IMAGES);
    json_t *use = json_pack("{s:i}", "index", maker_add(maker, "textures", json_pack("{s:i}", "source", image)));
    if (other && way == SECOND_SET)
        json_object_set_new(use, "texCoord", json_integer(1));
    if (other && way == NAMED_BY_TRANSFORM)
        json_object_set_new(use, "extensions", json_pack("{s:{s:i}}", "KHR_texture_transform", "texCoord", 1));
    if (other && way == TRANSFORMED)
        json_object_set_new(use, "extensions",
                            json_pack("{s:{s:[f,f],s:[f,f]}}", "KHR_texture_transform", "offset", 1.0, 0.0, "scale", -1.0, 1.0));
    return use;
}

static int add_material(struct model_maker *maker, enum way way)
{
    json_t *pbr = json_pack("{s:o}", "baseColorTexture", use_of(maker, BASE, way));
    json_t *material = json_pack("{s:s,s:o,s:[f,f,f],s:b}", "name", "paint", "pbrMetallicRoughness", pbr, "emissiveFactor", 1.0, 1.0, 1.0,
                                 "doubleSided", 1);
    if (way == BASE_ONLY) {
        json_object_set_new(pbr, "metallicFactor", json_real(0));
        json_object_set_new(material, "emissiveFactor", json_pack("[f,f,f]", 0.0, 0.0, 0.0));
        return maker_add(maker, "materials", material);
    }
    json_object_set_new(pbr, "metallicRoughnessTexture", use_of(maker, METAL, way));
    json_object_set_new(material, "normalTexture", use_of(maker, NORMAL, way));
    json_object_set_new(material, "occlusionTexture", use_of(maker, OCCLUSION, way));
    json_object_set_new(material, "emissiveTexture", use_of(maker, GLOW, way));
    return maker_add(maker, "materials", material);
}

static int add_mesh(struct model_maker *maker, const struct wavy_sheet *s, enum way way)
{
    float(*mirrored)[2] = mem_array(s->vertex_count, sizeof(*mirrored));
    for (uint32_t v = 0; v < s->vertex_count; v++)
        memcpy(mirrored[v], (float[2]){ 1 - s->texcoords[v][0], s->texcoords[v][1] }, sizeof(*mirrored));
    json_t *attributes = json_object();
    json_object_set_new(attributes, "POSITION",
                        json_integer(maker_numbers(maker, s->positions, 12 * s->vertex_count, FLOAT, s->vertex_count, "VEC3")));
    json_object_set_new(attributes, "NORMAL",
                        json_integer(maker_numbers(maker, s->normals, 12 * s->vertex_count, FLOAT, s->vertex_count, "VEC3")));
    json_object_set_new(attributes, "TEXCOORD_0",
                        json_integer(maker_numbers(maker, s->texcoords, 8 * s->vertex_count, FLOAT, s->vertex_count, "VEC2")));
    if (way == SECOND_SET || way == NAMED_BY_TRANSFORM)
        json_object_set_new(attributes, "TEXCOORD_1",
                            json_integer(maker_numbers(maker, mirrored, 8 * s->vertex_count, FLOAT, s->vertex_count, "VEC2")));
    mem_free(mirrored);
    int indices = maker_numbers(maker, s->indices, 4 * s->index_count, UINT, s->index_count, "SCALAR");
    return maker_mesh(maker,
                      json_pack("{s:o,s:i,s:i}", "attributes", attributes, "indices", indices, "material", add_material(maker, way)));
}

static void write_model(const char *folder, enum way way)
{
    struct wavy_sheet sheet = sheet_create(32, 16);
    struct model_maker maker;
    maker_init(&maker);
    maker_node(&maker, "sheet", add_mesh(&maker, &sheet, way), NULL);
    maker_write(&maker, folder, "sheet.glb");
}

/* --- its picture ----------------------------------------------------------------------------------------------------------------- */

static void save(const struct frame *frame, enum way way)
{
    const char *folder = getenv("PLANTCAST_PICTURES");
    png_image image = { .version = PNG_IMAGE_VERSION, .width = WIDTH, .height = HEIGHT, .format = PNG_FORMAT_BGRA };
    if (!folder)
        return;
    char *path = test_printf("%s/second_texcoords-%d.png", folder, way);
    uint8_t *packed = mem_array((size_t)WIDTH * HEIGHT, 4);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        memcpy(packed + 4 * i, frame_pixel(frame, i % WIDTH, i / WIDTH), 3);
        packed[4 * i + 3] = 255;
    }
    png_image_write_to_file(&image, path, 0, packed, 0, NULL);
    mem_free(packed);
}

/* Draws the model after preparation by plantcast-prep, with levels of detail and with triangles subdivided for its sensors. */
static struct frame *picture_of(struct prep_case *c, enum way way)
{
    struct site site;
    struct view view;
    write_model(c->folder, way);
    prep_case_expect(c, "\"$PLANT\"", 0);
    assert_true(site_init(&site, &rig, c->plant, NULL));
    assert_true(site.scene->assets[0].file->view.levels[0].added_count > 0);
    view_default(site.scene, WIDTH, HEIGHT, &view);
    view.camera = (struct camera){ .eye_m = { 1.2, -1.1, 2.2 }, .target_m = { 1, 0.5, 0 }, .up = { 0, 0, 1 }, .fov_deg = 40 };
    view.tier = TIER_REFINED;
    view.look = LOOK_MATERIALS;
    struct frame *frame = split_view_draw_now(site.renderer, &view, site.snapshot);
    assert_non_null(frame);
    save(frame, way);
    site_finish(&site);
    return frame;
}

struct difference {
    int most;            /* largest difference of a colour channel between the two frames, of 255 */
    double mean, beyond; /* mean: mean difference of 255; beyond: share of the pixels that differ by more than 8 */
};

static struct difference compare(const struct frame *a, const struct frame *b)
{
    struct difference d = { 0 };
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int most = 0;
        for (int c = 0; c < 3; c++) {
            int apart = abs(frame_pixel(a, i % WIDTH, i / WIDTH)[c] - frame_pixel(b, i % WIDTH, i / WIDTH)[c]);
            most = apart > most ? apart : most;
            d.mean += apart / (3.0 * WIDTH * HEIGHT);
        }
        d.most = most > d.most ? most : d.most;
        d.beyond += (most > 8) / (1.0 * WIDTH * HEIGHT);
    }
    return d;
}

TEST_WITH(every_way_to_say_it_looks_the_same, prep_case_set_up, prep_case_tear_down)
{
    struct frame *frames[WAYS];
    struct difference d[WAYS];
    struct prep_case *c = *state;
    prep_case_plant(c, PLANT);
    prep_case_tags(c, "T-1,400001,Float,plc,temperature,sheet,,0.3,0.4,0\nT-2,400003,Float,plc,temperature,sheet,,1.6,0.7,0\n");
    for (int way = 0; way < WAYS; way++) {
        frames[way] = picture_of(c, way);
        d[way] = compare(frames[SECOND_SET], frames[way]);
        print_message("# %-18s differs from the second set by %3d at most, %.3f in the mean, more than 8 in %.3f %%\n", way_names[way],
                      d[way].most, d[way].mean, 100 * d[way].beyond);
    }
    assert_int_equal(d[NAMED_BY_TRANSFORM].most, 0);
    assert_true(d[TRANSFORMED].most <= 1);
    /* mirrored images may differ slightly, because rounding decides which texel is used at the borders of texels */
    assert_true(d[MIRRORED_IMAGES].mean < 0.1 && d[MIRRORED_IMAGES].beyond < 0.001);
    /* checks that the four textures are visible at all; otherwise the comparisons above would prove nothing */
    assert_true(d[BASE_ONLY].mean > 3);
    for (int way = 0; way < WAYS; way++)
        frame_unref(&frames[way]);
}
