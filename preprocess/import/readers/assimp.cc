/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-import-assimp INPUT OUTPUT.glb CHORD_MM UNITS UP ENCODING`: reads OBJ, STL, PLY, FBX, COLLADA and 3DS with Assimp, in its own
 * process. UNITS, UP or ENCODING `-`: use the file's value, else guess and print the guess. On failure the last line on stderr is the
 * reason. */
#include <assimp/DefaultIOSystem.h>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <strings.h>
#include <vector>

extern "C" {
#include "base/image/srgb.h"
}
#include "preprocess/glb/glb_scene.h"
#include "preprocess/import/readers/assimp_losses.hh"
#include "preprocess/import/readers/reader.hh"

namespace
{

constexpr size_t MOST_NAMED = 20;
/* Size in metres of the largest plausible model. If a model without a unit would be larger than this in metres, its unit is
   assumed to be the millimetre. */
constexpr double LONGEST_IN_METRES = 300;
constexpr double COARSE_M = 1e-3; /* spacing in metres of the positions that Assimp can represent, above which the import reports it */
/* An OBJ file whose distance from the origin exceeds this multiple of its size is moved to the origin before Assimp reads it. */
constexpr double FAR_SIZES = 4;

struct format {
    const char *ending;
    const char *unit, *up; /* unit and up axis of the data that Assimp returns for this format; NULL: the file does not give them */
    /* true: use the file's normals; false: they belong to flat facets, so smooth normals are computed */
    bool own_normals;
};

/* Assimp converts COLLADA and 3DS to Y up and applies COLLADA's units. For FBX, older versions of Assimp convert neither axes
 * nor units: see fbx_axes(). */
const format formats[] = { { ".obj", nullptr, nullptr, true }, { ".stl", nullptr, nullptr, false }, { ".ply", nullptr, nullptr, true },
                           { ".fbx", "cm", "y", true },        { ".dae", "m", "y", true },          { ".3ds", nullptr, "y", true } };

struct assimp_reader {
    const aiScene *scene;
    struct glb_scene *out;
    text_encoding encoding;     /* text encoding of the names; Assimp returns them as the file's raw bytes */
    /* by index of the Assimp material: index of the material in the written GLB file (glb_scene.h); -2: not created yet */
    std::vector<int> materials;
    /* by a node's list of Assimp meshes: index of the mesh in the written GLB file; nodes with the same list share a mesh */
    std::map<std::vector<unsigned>, int> meshes;
    size_t triangles = 0, lost = 0; /* lost: number of triangles omitted because a corner is not finite */
    std::vector<std::string> lines; /* names of nodes omitted because they consist only of lines or points */
    std::vector<std::string> holed; /* names of nodes some of whose triangles were omitted */
};

/* --- files ---------------------------------------------------------------------------------------------------- */

constexpr size_t PLY_HEAD = 100; /* number of bytes at the start of a PLY file that are searched for its format */
constexpr char BLANK = 0x1f; /* replaces blanks inside names of an OBJ or STL file, because Assimp ends names at a blank */

/* Replaces blanks inside names with BLANK: in lines `o NAME` and `g NAME` of an OBJ file, `solid NAME` of an STL file. */
void keep_blanks(char *bytes, size_t count, bool stl)
{
    const size_t word = stl ? 5 : 1;
    for (size_t i = 0; i < count; i++) {
        size_t end = i;
        while (end < count && bytes[end] != '\n' && bytes[end] != '\r')
            end++;
        bool known = stl ? end - i > word && !strncmp(bytes + i, "solid", word) : bytes[i] == 'o' || bytes[i] == 'g';
        bool named = known && end - i > word + 1 && bytes[i + word] == ' ';
        size_t last = end;
        while (named && last > i && bytes[last - 1] == ' ')
            last--;
        for (size_t k = i + word + 1; named && k < last; k++)
            if (bytes[k] == ' ' && bytes[k - 1] != ' ')
                bytes[k] = BLANK;
        i = end;
    }
}

/* Returns the text encoding from an XML declaration. Overwrites it with blanks in the text, which is converted to UTF-8 before
 * it is parsed. */
std::string take_declared(std::string *text)
{
    size_t end = text->compare(0, 5, "<?xml") == 0 ? text->find("?>") : std::string::npos, from = text->find("encoding=");
    if (end == std::string::npos || from >= end || from + 10 >= end)
        return "";
    size_t close = text->find((*text)[from + 9], from + 10);
    if (close == std::string::npos || close >= end)
        return "";
    std::string name = text->substr(from + 10, close - from - 10);
    text->replace(from, close + 1 - from, close + 1 - from, ' ');
    return name;
}

/* Returns whether an STL file is text. Some binary files also begin with "solid", like text files, but their size is exactly
 * the header plus 50 bytes per triangle. */
bool is_text_of_stl(const std::string &bytes)
{
    uint32_t triangles = 0;
    if (bytes.size() >= 84)
        memcpy(&triangles, &bytes[80], sizeof(triangles));
    return bytes.size() > 5 && !strncasecmp(bytes.c_str(), "solid", 5) && bytes.size() != 84 + 50 * static_cast<uint64_t>(triangles);
}

/* Converts the keywords of an STL text to lower case, the only case Assimp accepts. The names of solids stay unchanged. */
std::string with_small_words(std::string text)
{
    /* blank: only blanks have been read so far in the current line; named: the position is inside the name of a solid */
    bool blank = true, named = false;
    for (size_t i = 0; i < text.size(); i++) {
        bool space = isspace(static_cast<unsigned char>(text[i])) != 0;
        if (text[i] == '\n' || text[i] == '\r') {
            blank = true;
            named = false;
            continue;
        }
        if (blank && !space)
            named = strncasecmp(&text[i], "solid", 5) == 0 || strncasecmp(&text[i], "endsolid", 8) == 0;
        for (; blank && named && i < text.size() && !isspace(static_cast<unsigned char>(text[i])); i++)
            text[i] = static_cast<char>(tolower(static_cast<unsigned char>(text[i])));
        blank = blank && space;
        if (!named && i < text.size())
            text[i] = static_cast<char>(tolower(static_cast<unsigned char>(text[i])));
        if (named && i < text.size() && (text[i] == '\n' || text[i] == '\r'))
            i--;
    }
    return text;
}

/* Reads the position on a line `v X Y Z` of an OBJ file. Returns the number of bytes up to the end of Z, or 0 if Assimp may read
 * the line in another way: as homogeneous coordinates, or as more or less than one line. */
size_t obj_position(const std::string &line, double position[3])
{
    const char *at = line.c_str() + 1;
    for (int axis = 0; axis < 3; axis++) {
        char *end;
        position[axis] = strtod(at, &end);
        if (end == at || (*end && !isspace(static_cast<unsigned char>(*end))))
            return 0;
        at = end;
    }
    const size_t used = static_cast<size_t>(at - line.c_str()), next = line.find_first_not_of(" \t\r", used);
    const size_t end = std::min(line.find_first_of(" \t\r", next), line.size());
    const bool fourth = next != std::string::npos && line.find_first_not_of(" \t\r", end) == std::string::npos;
    const bool joined = line.find('\\') != std::string::npos || line.find('\r') < line.size() - 1;
    return fourth || joined ? 0 : used;
}

bool finite(const double position[3])
{
    return std::isfinite(position[0]) && std::isfinite(position[1]) && std::isfinite(position[2]);
}

/* Moves the positions of an OBJ file to the origin if they are far from it, because Assimp stores positions as float: at 5,800 km from
 * the origin, a float has steps of 0.5 m. Sets `offset` to the vector that the file's positions were reduced by. */
void shift_obj(std::string *text, double offset[3])
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, position[3], size = 0, far = 0;
    const auto is_vertex = [text](size_t at) {
        at = std::min(text->find_first_not_of(" \t", at), text->size());
        return text->compare(at, 2, "v ") == 0 || text->compare(at, 2, "v\t") == 0;
    };
    std::fill(offset, offset + 3, 0.0);
    for (size_t at = 0, end; at < text->size(); at = end + 1) {
        end = std::min(text->find('\n', at), text->size());
        if (!is_vertex(at))
            continue;
        if (obj_position(text->substr(at, end - at), position) == 0)
            return;
        for (int axis = 0; axis < 3 && finite(position); axis++) {
            low[axis] = std::fmin(low[axis], position[axis]);
            high[axis] = std::fmax(high[axis], position[axis]);
        }
    }
    for (int axis = 0; axis < 3 && low[axis] <= high[axis]; axis++) {
        size = std::fmax(size, high[axis] - low[axis]);
        offset[axis] = std::round(low[axis] / 2 + high[axis] / 2);
        far = std::fmax(far, std::fabs(offset[axis]));
    }
    if (!(far > FAR_SIZES * size)) {
        std::fill(offset, offset + 3, 0.0);
        return;
    }
    std::string moved;
    moved.reserve(text->size());
    for (size_t at = 0, end; at < text->size(); at = end + 1) {
        end = std::min(text->find('\n', at), text->size());
        const std::string line = text->substr(at, end - at);
        const size_t used = is_vertex(at) ? obj_position(line, position) : 0;
        if (used > 0 && finite(position)) {
            char numbers[100];
            snprintf(numbers, sizeof(numbers), "v %.9g %.9g %.9g", position[0] - offset[0], position[1] - offset[1],
                     position[2] - offset[2]);
            moved += numbers + line.substr(used) + "\n";
        } else {
            moved += line + "\n";
        }
    }
    *text = std::move(moved);
}

Assimp::IOStream *of_text(const std::string &text)
{
    auto *copy = new uint8_t[text.size() + 1];
    memcpy(copy, text.data(), text.size());
    return new Assimp::MemoryIOStream(copy, text.size(), true);
}

/* Supplies Assimp with the model and the files it refers to, converted to UTF-8 and with BLANK for blanks in names. The
 * encoding found for the first file (the model) applies to all others, because names in material files must match those in the
 * model. */
struct files : Assimp::DefaultIOSystem {
    text_encoding *encoding;
    const char *asked;
    /* true: the file has been searched for lost shapes; Assimp opens it several times, but one search is enough */
    bool searched = false;
    double *offset; /* vector by which the positions of an OBJ file are reduced (shift_obj) */

    files(text_encoding *encoding_of_all, const char *asked_for, double offset_of_obj[3])
        : encoding(encoding_of_all), asked(asked_for), offset(offset_of_obj)
    {
    }
    Assimp::IOStream *Open(const char *path, const char *mode) override
    {
        const char *dot = strrchr(path, '.');
        Assimp::IOStream *file = DefaultIOSystem::Open(path, mode);
        auto ends = [dot](const char *ending) { return dot && !strcasecmp(dot, ending); };
        bool obj = ends(".obj"), stl = ends(".stl"), dae = ends(".dae"), fbx = ends(".fbx"), ply = ends(".ply");
        if (!file || (!obj && !dae && !stl && !fbx && !ply && !ends(".mtl")))
            return file;
        std::string text(file->FileSize(), 0);
        text.resize(text.empty() ? 0 : file->Read(&text[0], 1, text.size()));
        Close(file);
        if (fbx && !searched)
            assimp_losses_of_fbx(text);
        bool binary = (fbx && text.compare(0, 18, "Kaydara FBX Binary") == 0) || (stl && !is_text_of_stl(text)) ||
                      (ply && text.substr(0, PLY_HEAD).find("\nformat ascii") == std::string::npos);
        if (!binary)
            assimp_plain_numbers(&text);
        if (fbx && !binary)
            assimp_mend_fbx(&text, !searched);
        if (fbx || ply) {
            searched = true;
            return of_text(text);
        }
        if (stl) {
            if (is_text_of_stl(text)) {
                text = with_small_words(text);
                keep_blanks(&text[0], text.size(), true);
            }
            return of_text(text);
        }
        std::string said = dae ? take_declared(&text) : "";
        if (encoding->choice.ascii) {
            encoding->choose(text, asked, said.c_str());
            encoding->say();
        }
        text = encoding->utf8(text);
        if (dae && !searched)
            assimp_losses_of_dae(text);
        if (obj && !searched)
            assimp_losses_of_obj(text);
        searched |= dae || obj;
        if (obj) {
            keep_blanks(&text[0], text.size(), false);
            shift_obj(&text, offset);
        }
        return of_text(text);
    }
};

/* --- units and axes ---------------------------------------------------------------------------------------------------- */

double metres_of(const char *unit)
{
    const struct {
        const char *name;
        double m;
    } units[] = { { "m", 1 }, { "mm", 1e-3 }, { "cm", 1e-2 }, { "in", 0.0254 }, { "ft", 0.3048 } };
    for (const auto &known : units)
        if (!strcmp(known.name, unit))
            return known.m;
    refuse("unit %s is unknown", unit);
}

void grow(const aiScene *scene, const aiNode *node, const aiMatrix4x4 &above, double low[3], double high[3])
{
    aiMatrix4x4 world = above * node->mTransformation;
    for (unsigned m = 0; m < node->mNumMeshes; m++) {
        const aiMesh *mesh = scene->mMeshes[node->mMeshes[m]];
        const bool shown = (mesh->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0;
        for (unsigned i = 0; shown && i < mesh->mNumVertices; i++) {
            aiVector3D p = world * mesh->mVertices[i];
            const double at[3] = { static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z) };
            for (int axis = 0; axis < 3; axis++)
                if (std::isfinite(at[axis])) {
                    low[axis] = std::fmin(low[axis], at[axis]);
                    high[axis] = std::fmax(high[axis], at[axis]);
                }
        }
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        grow(scene, node->mChildren[i], world, low, high);
}

double longest_side(const aiScene *scene)
{
    double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY }, longest = 0;
    grow(scene, scene->mRootNode, aiMatrix4x4(), low, high);
    for (int axis = 0; axis < 3; axis++)
        longest = std::fmax(longest, high[axis] - low[axis]);
    return longest;
}

/* Distance of a model from its origin, and the resulting spacing of the positions that Assimp can represent as float. */
struct rounding {
    double distance = 0, spacing = 0;

    void add(const aiVector3D &v, double scale)
    {
        const float far = std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z)));
        if (!std::isfinite(far) || !std::isfinite(scale))
            return;
        distance = std::fmax(distance, static_cast<double>(far) * scale);
        spacing = std::fmax(spacing, (static_cast<double>(std::nextafter(far, INFINITY)) - static_cast<double>(far)) * scale);
    }
};

/* Adds the positions of all meshes below a node, and the translations of the nodes that have them. above: the largest distance and
 * spacing among the translations of the nodes above; scale: the scale of the nodes above. Each position is measured in the frame in
 * which Assimp stores it. */
void add_rounding(const aiScene *scene, const aiNode *node, rounding above, double scale, rounding *out)
{
    const aiMatrix4x4 &m = node->mTransformation;
    above.add(aiVector3D(m.a4, m.b4, m.c4), scale);
    scale *= static_cast<double>(std::fmax(aiVector3D(m.a1, m.b1, m.c1).Length(),
                                           std::fmax(aiVector3D(m.a2, m.b2, m.c2).Length(), aiVector3D(m.a3, m.b3, m.c3).Length())));
    for (unsigned k = 0; k < node->mNumMeshes; k++) {
        const aiMesh *mesh = scene->mMeshes[node->mMeshes[k]];
        rounding found = above;
        for (unsigned i = 0; i < mesh->mNumVertices; i++)
            found.add(mesh->mVertices[i], scale);
        if ((mesh->mPrimitiveTypes & aiPrimitiveType_TRIANGLE) != 0) {
            out->distance = std::fmax(out->distance, found.distance);
            out->spacing = std::fmax(out->spacing, found.spacing);
        }
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        add_rounding(scene, node->mChildren[i], above, scale, out);
}

/* Reports a model that is so far from its origin that its shapes are visibly deformed. m: metres per unit of the model. */
void say_rounding(const aiScene *scene, double m)
{
    rounding found;
    add_rounding(scene, scene->mRootNode, rounding(), m, &found);
    if (found.spacing > COARSE_M)
        printf("error\t1\tthe model has coordinates up to %.0f m from its origin: positions are rounded to steps of %.3g mm: export the "
               "model with an origin near the plant\n",
               found.distance, found.spacing * 1000);
}

/* Returns centimetres per unit of an FBX file, and its up axis. Returns 1 if the root node has a transform, because newer versions of
 * Assimp put units and axes into that transform. */
double fbx_axes(const aiScene *scene, const char **axis)
{
    double centimetres = 1;
    float single = 1;
    int32_t up = 1;
    if (!scene->mMetaData || !scene->mRootNode->mTransformation.IsIdentity())
        return 1;
    if (!scene->mMetaData->Get("UnitScaleFactor", centimetres) && scene->mMetaData->Get("UnitScaleFactor", single))
        centimetres = static_cast<double>(single);
    if (scene->mMetaData->Get("UpAxis", up) && up == 2)
        *axis = "z";
    return std::isfinite(centimetres) && centimetres > 0 ? centimetres : 1;
}

/* Computes the root node's transform from the model's unit and up axis: the user's choice, else the file's, else a guess. offset: vector
 * in units of the model, which the transform adds to all positions. */
void root_matrix(const aiScene *scene, const format &from, const char *units, const char *up, const double offset[3], double out[16])
{
    const char *unit = strcmp(units, "-") != 0 ? units : from.unit;
    if (!unit) {
        double longest = longest_side(scene);
        unit = longest > LONGEST_IN_METRES ? "mm" : "m";
        printf(
            "the file states no unit: assuming %s, which makes the model's length of %.4g equal to %.4g m; if that is wrong, set --units "
            "(m, mm, cm, in, ft)\n",
            unit, longest, longest * metres_of(unit));
        printf("unit\t%s\t%.9g\n", unit, longest);
    }
    const char *axis = strcmp(up, "-") != 0 ? up : from.up;
    if (!axis) {
        axis = strcmp(from.ending, ".obj") == 0 ? "y" : "z";
        printf("the file states no up axis: assuming %s, as usual for %s; if that is wrong, set --up\n", axis, from.ending);
    }
    double m = metres_of(unit) * (strcmp(from.ending, ".fbx") == 0 ? fbx_axes(scene, &axis) : 1);
    const double y_up[16] = { m, 0, 0, 0, 0, m, 0, 0, 0, 0, m, 0, 0, 0, 0, 1 },
                 z_up[16] = { m, 0, 0, 0, 0, 0, -m, 0, 0, m, 0, 0, 0, 0, 0, 1 };
    memcpy(out, axis[0] == 'y' ? y_up : z_up, sizeof(y_up));
    for (int row = 0; row < 3; row++)
        for (int axis_of_file = 0; axis_of_file < 3; axis_of_file++)
            out[12 + row] += out[4 * axis_of_file + row] * offset[axis_of_file];
    say_rounding(scene, m);
}

/* --- meshes ---------------------------------------------------------------------------------------------------- */

int material_of(assimp_reader *r, unsigned number)
{
    if (number >= r->materials.size())
        return -1;
    if (r->materials[number] != -2)
        return r->materials[number];
    const aiMaterial *material = r->scene->mMaterials[number];
    aiColor3D color(0.6F, 0.6F, 0.6F);
    ai_real opacity = 1;
    material->Get(AI_MATKEY_COLOR_DIFFUSE, color);
    material->Get(AI_MATKEY_OPACITY, opacity);
    const double given[4] = { static_cast<double>(color.r), static_cast<double>(color.g), static_cast<double>(color.b),
                              static_cast<double>(opacity) };
    double rgba[4];
    for (int i = 0; i < 4; i++) {
        double value = std::isfinite(given[i]) ? std::fmin(std::fmax(given[i], 0), 1) : 1;
        rgba[i] = i < 3 ? linear_from_srgb(value) : value;
    }
    return r->materials[number] = glb_scene_material(r->out, rgba);
}

bool finite(const aiVector3D &v)
{
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::vector<uint32_t> corners_of(assimp_reader *r, const aiMesh *mesh)
{
    std::vector<uint32_t> corners;
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const aiFace &face = mesh->mFaces[i];
        bool good = face.mNumIndices == 3;
        for (unsigned k = 0; good && k < 3; k++)
            good = face.mIndices[k] < mesh->mNumVertices && finite(mesh->mVertices[face.mIndices[k]]);
        if (good)
            corners.insert(corners.end(), face.mIndices, face.mIndices + 3);
        else if (face.mNumIndices == 3)
            r->lost++;
    }
    return corners;
}

void add_primitive(assimp_reader *r, int to, const aiMesh *mesh, const std::vector<uint32_t> &corners)
{
    std::vector<float> positions, normals;
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        aiVector3D p = finite(mesh->mVertices[i]) ? mesh->mVertices[i] : aiVector3D(), n(0, 1, 0);
        if (mesh->mNormals && finite(mesh->mNormals[i]) && mesh->mNormals[i].Length() > 1e-6F)
            n = aiVector3D(mesh->mNormals[i]).Normalize();
        positions.insert(positions.end(), { static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z) });
        normals.insert(normals.end(), { static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z) });
    }
    const struct glb_scene_triangles triangles = { reinterpret_cast<const float(*)[3]>(positions.data()),
                                                   mesh->mNormals ? reinterpret_cast<const float(*)[3]>(normals.data()) : nullptr,
                                                   mesh->mNumVertices,
                                                   corners.data(),
                                                   corners.size(),
                                                   material_of(r, mesh->mMaterialIndex) };
    glb_scene_add_triangles(r->out, to, &triangles);
    r->triangles += corners.size() / 3;
}

/* Returns an Assimp name in UTF-8. Names in angle brackets, such as <STL_BINARY>, are added by Assimp and become "". */
std::string name_of(const assimp_reader *r, const aiString &from)
{
    std::string name = from.C_Str()[0] == '<' ? "" : r->encoding.utf8(from.C_Str());
    for (char &c : name)
        c = c == BLANK ? ' ' : c;
    return name;
}

/* Prints a line about a node that has meshes but no triangles. */
void say_empty(assimp_reader *r, const aiNode *node)
{
    std::string name = one_line(name_of(r, node->mName));
    unsigned types = 0;
    for (unsigned m = 0; m < node->mNumMeshes; m++)
        types |= r->scene->mMeshes[node->mMeshes[m]]->mNumFaces > 0 ? r->scene->mMeshes[node->mMeshes[m]]->mPrimitiveTypes : 0U;
    if (types != 0 && (types & ~static_cast<unsigned>(aiPrimitiveType_LINE | aiPrimitiveType_POINT)) == 0)
        r->lines.push_back(name.empty() ? "a node without a name" : name);
    else
        printf("lost\t\t%s\tnode\t\t%s\n", name.c_str(),
               types == 0 ? "the node's mesh has no triangles"
                          : "all triangles of the node have coordinates that are infinite or not numbers");
}

/* Returns the mesh for a node in the written GLB file, creating it if necessary. Returns -1 if the node has no triangles. */
int mesh_of(assimp_reader *r, const aiNode *node)
{
    std::vector<unsigned> parts(node->mMeshes, node->mMeshes + node->mNumMeshes);
    auto known = r->meshes.find(parts);
    if (known != r->meshes.end())
        return known->second;
    int made = -1;
    for (unsigned part : parts) {
        const aiMesh *mesh = r->scene->mMeshes[part];
        std::vector<uint32_t> corners = corners_of(r, mesh);
        if (corners.empty())
            continue;
        if (made < 0)
            made = glb_scene_add_mesh(r->out, name_of(r, mesh->mName).c_str());
        add_primitive(r, made, mesh, corners);
    }
    r->meshes[parts] = made;
    return made;
}

/* --- nodes ---------------------------------------------------------------------------------------------------- */

void add_properties(assimp_reader *r, int to, const aiMetadata *data)
{
    for (unsigned i = 0; data && i < data->mNumProperties; i++) {
        const aiMetadataEntry &entry = data->mValues[i];
        char number[64] = "";
        const char *text = number;
        switch (entry.mType) {
        case AI_AISTRING: text = static_cast<const aiString *>(entry.mData)->C_Str(); break;
        case AI_BOOL: text = *static_cast<const bool *>(entry.mData) ? "true" : "false"; break;
        case AI_INT32: snprintf(number, sizeof(number), "%d", *static_cast<const int32_t *>(entry.mData)); break;
        case AI_FLOAT: snprintf(number, sizeof(number), "%.9g", static_cast<double>(*static_cast<const float *>(entry.mData))); break;
        case AI_DOUBLE: snprintf(number, sizeof(number), "%.15g", *static_cast<const double *>(entry.mData)); break;
        default: continue;
        }
        if (text[0] && strcmp(data->mKeys[i].C_Str(), "IsNull") != 0)
            glb_scene_set_property(r->out, to, r->encoding.utf8(data->mKeys[i].C_Str()).c_str(), r->encoding.utf8(text).c_str());
    }
}

using transform = aiMatrix4x4t<double>;

transform transform_of(const aiNode *node)
{
    const aiMatrix4x4 &m = node->mTransformation;
    return transform(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4);
}

void matrix_of(const aiNode *node, const transform &place, double matrix[16])
{
    for (unsigned row = 0; row < 4; row++)
        for (unsigned column = 0; column < 4; column++) {
            matrix[4 * column + row] = place[row][column];
            if (!std::isfinite(matrix[4 * column + row]))
                refuse("node '%.80s': the node's position is infinite or not a number: export the model again", node->mName.C_Str());
        }
}

/* Appends the names and text properties of a node and its subtree to *out, one per line; the encoding is detected from them. */
void collect(const aiScene *scene, const aiNode *node, std::string *out)
{
    *out += std::string(node->mName.C_Str()) + "\n";
    for (unsigned i = 0; i < node->mNumMeshes; i++)
        *out += std::string(scene->mMeshes[node->mMeshes[i]]->mName.C_Str()) + "\n";
    for (unsigned i = 0; node->mMetaData && i < node->mMetaData->mNumProperties; i++) {
        const aiMetadataEntry &entry = node->mMetaData->mValues[i];
        *out += std::string(node->mMetaData->mKeys[i].C_Str()) + "\n";
        if (entry.mType == AI_AISTRING)
            *out += std::string(static_cast<const aiString *>(entry.mData)->C_Str()) + "\n";
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        collect(scene, node->mChildren[i], out);
}

/* Returns whether Assimp made this node by splitting the transform of an FBX node into a chain of nodes. This program merges
 * such a chain into one node again. */
bool is_step(const aiNode *node)
{
    return strstr(node->mName.C_Str(), "_$AssimpFbx$_") != nullptr;
}

void add(assimp_reader *r, const aiNode *node, const transform &steps, int parent, int depth)
{
    double matrix[16];
    /* true: the root node that Assimp adds to every model; it is omitted from the output */
    bool made_up = depth == 0 && node->mNumMeshes == 0 && node->mTransformation.IsIdentity();
    bool step = is_step(node) && node->mNumMeshes == 0;
    transform place = steps * transform_of(node);
    if (depth > MAX_DEPTH)
        refuse("nodes are nested deeper than %d levels", MAX_DEPTH);
    matrix_of(node, place, matrix);
    int number = parent;
    if (!made_up && !step) {
        const size_t lost = r->lost;
        const int mesh = mesh_of(r, node);
        if (r->lost > lost)
            r->holed.push_back(name_of(r, node->mName));
        if (mesh < 0 && node->mNumMeshes > 0)
            say_empty(r, node);
        number = glb_scene_add_node(r->out, parent, name_of(r, node->mName).c_str(), mesh,
                                    place.IsIdentity() ? nullptr : matrix);
        add_properties(r, number, node->mMetaData);
    }
    for (unsigned i = 0; i < node->mNumChildren; i++)
        add(r, node->mChildren[i], step ? place : transform(), number, depth + !step);
}

const format &format_of(const char *path)
{
    const char *dot = strrchr(path, '.');
    for (const format &known : formats)
        if (dot && !strcasecmp(known.ending, dot))
            return known;
    refuse("unknown file ending: `plantcast import --formats` prints the known ones");
}

/* Rejects a truncated STL text file, because Assimp would silently read the part that is there. */
void check_end_of_stl(const char *path)
{
    char head[512] = "", tail[512] = "";
    FILE *file = fopen(path, "rb");
    if (!file)
        refuse("%s", strerror(errno));
    size_t read = fread(head, 1, sizeof(head) - 1, file);
    if (fseek(file, -static_cast<long>(sizeof(tail) - 1), SEEK_END) != 0)
        rewind(file);
    read += fread(tail, 1, sizeof(tail) - 1, file);
    fclose(file);
    if (read > 0 && !strncasecmp(head, "solid", 5) && strcasestr(head, "facet") && !strcasestr(tail, "endsolid"))
        refuse("the file is truncated: it does not end with endsolid");
}

std::string listed(const std::vector<std::string> &names)
{
    std::string all;
    for (size_t i = 0; i < names.size() && i < MOST_NAMED; i++)
        all += (i > 0 ? ", " : "") + one_line(names[i]);
    return all + (names.size() > MOST_NAMED ? ", ..." : "");
}

/* Prints that a model's textures are ignored: this program keeps only the colours of materials. */
void say_textures(const aiScene *scene)
{
    std::set<std::string> names;
    for (unsigned m = 0; m < scene->mNumMaterials; m++)
        for (int type = aiTextureType_DIFFUSE; type <= AI_TEXTURE_TYPE_MAX; type++)
            for (unsigned i = 0; i < scene->mMaterials[m]->GetTextureCount(static_cast<aiTextureType>(type)); i++) {
                aiString path;
                if (scene->mMaterials[m]->GetTexture(static_cast<aiTextureType>(type), i, &path) == AI_SUCCESS)
                    names.insert(path.C_Str());
            }
    if (!names.empty())
        printf("left out: %zu textures, such as %.100s\n", names.size(), one_line(*names.begin()).c_str());
}

void convert(const char *input, const char *output, const char *units, const char *up, const char *asked)
{
    const format &from = format_of(input);
    Assimp::Importer importer;
    if (strcmp(from.ending, ".stl") == 0)
        check_end_of_stl(input);
    unsigned steps = aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType | aiProcess_ValidateDataStructure;
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
    /* keeps FBX pivots as nodes: otherwise children would inherit a node's GeometricTranslation, which applies only to its own
       mesh */
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, true);
    text_encoding of_file;                             /* encoding in which text files are decoded before Assimp reads them */
    double offset[3] = { 0, 0, 0 };
    importer.SetIOHandler(new files(&of_file, asked, offset)); /* the importer takes ownership of this object */
    std::map<std::string, size_t> logged;
    Assimp::DefaultLogger::create("", Assimp::Logger::NORMAL, 0);
    /* the logger takes ownership of the log stream */
    Assimp::DefaultLogger::get()->attachStream(new assimp_log(logged), Assimp::Logger::Err | Assimp::Logger::Warn);
    steps |= from.own_normals ? 0U : static_cast<unsigned>(aiProcess_RemoveComponent);
    const aiScene *scene = importer.ReadFile(input, steps);
    /* Assimp refuses a whole model because of one empty mesh: read the model again without the post-processing steps that check for it */
    if (!scene && strstr(importer.GetErrorString(), "contains no "))
        scene = importer.ReadFile(input, steps & ~static_cast<unsigned>(aiProcess_ValidateDataStructure | aiProcess_SortByPType));
    if (!scene || !scene->mRootNode)
        refuse("%.250s", strcmp(importer.GetErrorString(), "std::bad_alloc") ? importer.GetErrorString() : "out of memory");
    Assimp::DefaultLogger::kill();
    for (const auto &entry : logged)
        printf("error\t%zu\tAssimp: %.300s\n", entry.second, entry.first.c_str());
    assimp_reader r = {};
    r.scene = scene;
    if (of_file.choice.ascii) {
        std::string names;
        collect(scene, scene->mRootNode, &names);
        r.encoding.choose(names, asked, "");
        r.encoding.say();
    }
    r.out = glb_scene_create("plantcast-import, Assimp");
    r.materials.assign(scene->mNumMaterials, -2);
    const char *slash = strrchr(input, '/'), *base = slash ? slash + 1 : input;
    double matrix[16];
    root_matrix(scene, from, units, up, offset, matrix);
    int root = glb_scene_add_node(r.out, -1, std::string(base, strlen(base) - strlen(from.ending)).c_str(), -1, matrix);
    add(&r, scene->mRootNode, transform(), root, 0);
    if (!r.lines.empty())
        printf("not shown: %zu nodes that consist only of lines or points: %s\n", r.lines.size(), listed(r.lines).c_str());
    if (r.triangles == 0)
        refuse("the file contains no surface: export meshes or surfaces, not only lines and points");
    write_scene(&r.out, output, "");
    say_textures(scene);
    if (r.lost > 0)
        printf("left out: %zu triangles whose coordinates are infinite or not numbers, in %s\n", r.lost, listed(r.holed).c_str());
}

} // namespace

int main(int argc, char **argv)
{
    return reader_main(argc, argv, "plantcast-import-assimp",
                       [](char **arguments) { convert(arguments[0], arguments[1], arguments[3], arguments[4], arguments[5]); });
}
