/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Vertex data on the GPU: normals decoded as shaders do, and texture coordinates stored in few bits where possible. */
#include "tests/support/test.h"

#include "gpu/mesh.h"
#include "gpu/program.h"
#include "tests/support/rig.h"
#include "tests/support/synthetic.h"

enum { COUNT = 20000 };
static const double MOST_DEG = 0.005; /* largest error of a normal, as server/gpu/mesh.h promises */
static struct rig rig;
static uint64_t seed = 71;
static float positions_m[COUNT][3], normals[COUNT][3], texcoords[COUNT][2];
static uint8_t colors[COUNT][4];
static const uint32_t indices[3] = { 0, 1, 2 };

static float random_signed(void)
{
    return (float)(2 * synthetic_random_unit(&seed) - 1);
}

/* Makes test normals: the poles, middles of edges and faces, the fold of the octahedron, and random ones. */
static void make_normals(void)
{
    size_t count = 0;
    for (int i = 0; i < 27; i++)
        if (i != 13)
            memcpy(normals[count++], (float[3]){ (float)(i % 3 - 1), (float)(i / 3 % 3 - 1), (float)(i / 9 - 1) }, sizeof(normals[0]));
    for (; count < 1000; count++)
        memcpy(normals[count], (float[3]){ random_signed(), random_signed(), 1e-5F * random_signed() }, sizeof(normals[0]));
    for (; count < COUNT; count++)
        memcpy(normals[count], (float[3]){ random_signed(), random_signed(), random_signed() }, sizeof(normals[0]));
    for (size_t i = 0; i < COUNT; i++) {
        float length = sqrtf(normals[i][0] * normals[i][0] + normals[i][1] * normals[i][1] + normals[i][2] * normals[i][2]);
        for (int c = 0; c < 3; c++)
            normals[i][c] = length > 0 ? normals[i][c] / length : c == 2;
    }
}

static struct gpu_mesh make(bool with_texcoords, bool with_colors)
{
    struct gpu_mesh mesh;
    struct mesh_params params = {
        .vertex_count = COUNT, .index_count = 3, .positions_m = positions_m, .normals = normals, .indices = indices
    };
    if (with_texcoords)
        params.texcoords = params.second_texcoords = texcoords;
    if (with_colors)
        params.colors = colors;
    assert_true(mesh_init(&mesh, rig.gl, "mesh", &params));
    return mesh;
}

static void unfold(const struct gpu_mesh *mesh, float (*out)[4])
{
    GLuint stages[2] = { program_compile(rig.log, GL_COMPUTE_SHADER, "unfold",
                                         "#include \"normal.glsl\"\n"
                                         "layout(local_size_x = 1) in;\n"
                                         "layout(std430, binding = 0) readonly buffer In { uint folded[]; };\n"
                                         "layout(std430, binding = 1) writeonly buffer Out { vec4 normals[]; };\n"
                                         "void main() { uint i = gl_WorkGroupID.x;\n"
                                         "normals[i] = vec4(unfold_normal(unpackSnorm2x16(folded[i])), 0.0); }\n",
                                         NULL) };
    GLuint program = program_link(rig.log, "unfold", stages), buffer = mesh_buffer(rig.log, "normals", COUNT * sizeof(*out), NULL, 0);
    assert_true(program && buffer);
    glUseProgram(program);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, mesh->normals);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffer);
    glDispatchCompute(COUNT, 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(buffer, 0, COUNT * (GLsizeiptr)sizeof(*out), out);
    glDeleteBuffers(1, &buffer);
    program_destroy(&program);
}

TEST(test_normals_come_back)
{
    static float out[COUNT][4];
    double most = 0;
    struct gpu_mesh mesh = make(false, false);
    unfold(&mesh, out);
    for (size_t i = 0; i < COUNT; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += pow((double)out[i][c] - (double)normals[i][c], 2);
        most = fmax(most, sqrt(square) * 180 / M_PI);
    }
    print_message("# normals: off by %.5f degrees at most\n", most);
    assert_true(most > 0 && most <= MOST_DEG);
    mesh_finish(&mesh);
}

static void set_texcoords(float low, float high)
{
    for (size_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 2; c++)
            texcoords[i][c] = low + (high - low) * (float)synthetic_random_unit(&seed);
    texcoords[0][0] = low;
    texcoords[COUNT - 1][1] = high;
}

TEST(test_texture_coordinates_that_fit_are_short)
{
    static uint16_t packed[COUNT][2];
    set_texcoords(0, 1);
    struct gpu_mesh mesh = make(true, false);
    assert_true(mesh.short_texcoords && mesh.short_second_texcoords);
    glGetNamedBufferSubData(mesh.second_texcoords, 0, sizeof(packed), packed);
    for (size_t i = 0; i < COUNT; i++)
        for (int c = 0; c < 2; c++)
            assert_true(fabs(packed[i][c] / 65535.0 - (double)texcoords[i][c]) <= 0.51 / 65535);
    assert_true(packed[0][0] == 0 && packed[COUNT - 1][1] == 65535);
    mesh_finish(&mesh);
}

TEST(test_others_stay_as_they_are)
{
    static float back[COUNT][2];
    for (int above = 0; above < 2; above++) {
        set_texcoords(above ? 0 : -1e-6F, above ? 1.000001F : 1);
        struct gpu_mesh mesh = make(true, false);
        assert_false(mesh.short_texcoords || mesh.short_second_texcoords);
        glGetNamedBufferSubData(mesh.texcoords, 0, sizeof(back), back);
        assert_memory_equal(back, texcoords, sizeof(back));
        mesh_finish(&mesh);
    }
}

TEST(test_bytes_of_its_own)
{
    set_texcoords(0, 1);
    for (int more = 0; more < 4; more++) {
        struct gpu_mesh mesh = make(more & 1, more & 2);
        GLuint buffers[] = { mesh.normals, mesh.texcoords, mesh.second_texcoords, mesh.positions, mesh.colors, mesh.indices };
        size_t sum = 0, own = rig.gl->reads_in_place ? 3 : sizeof(buffers) / sizeof(buffers[0]);
        for (size_t i = 0; i < own; i++) {
            GLint64 bytes = 0;
            if (buffers[i])
                glGetNamedBufferParameteri64v(buffers[i], GL_BUFFER_SIZE, &bytes);
            sum += (size_t)bytes;
        }
        size_t copied = own > 3 ? COUNT * (12 + (more & 2 ? 4 : 0)) + sizeof(indices) : 0;
        assert_int_equal(mesh.bytes, sum);
        assert_int_equal(sum, COUNT * (4 + (more & 1 ? 8 : 0)) + copied);
        mesh_finish(&mesh);
    }
}

/* Where the GPU can read the program's memory (reads_in_place), vertex data is not copied: later changes in that memory must be
   visible to the GPU. Data that had to be copied must not change. */
TEST(test_what_is_kept_is_read_in_place)
{
    static float back_m[COUNT][3];
    struct gl *gl = rig.gl;
    if (!gl->reads_in_place) {
        skip();
        return;
    }
    for (int in_place = 1; in_place >= 0; in_place--) {
        float before_m = positions_m[COUNT - 1][2];
        gl->reads_in_place = in_place;
        struct gpu_mesh mesh = make(false, true);
        positions_m[COUNT - 1][2] = before_m + 1;
        glGetNamedBufferSubData(mesh.positions, 0, sizeof(back_m), back_m);
        assert_memory_equal(back_m, positions_m, sizeof(back_m) - sizeof(float));
        assert_true(back_m[COUNT - 1][2] == (in_place ? before_m + 1 : before_m));
        mesh_finish(&mesh);
    }
    gl->reads_in_place = true;
}

int main(void)
{
    if (!rig_init(&rig, "mesh_test"))
        return 0;
    make_normals();
    int failed = tests_run(NULL);
    rig_finish(&rig);
    return failed;
}
