/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds shapes that Assimp skips without a message, by searching the text of the file for their statements. */
#include "preprocess/import/readers/assimp_losses.hh"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace
{

constexpr const char *LOSSES[] = { "ignoring unrecognized geometry", "ignoring empty geometry",    "skipping null geometry",
                                   "incoming Model link, ignoring",  "ither Material, NodeAttribute", "Unable to find geometry",
                                   "Vertex index overflow" };

/* Returns the value of an attribute of an XML tag; "" if the tag has no such attribute. */
std::string attribute(const std::string &tag, const std::string &name)
{
    const size_t from = tag.find(" " + name + "=");
    if (from == std::string::npos || from + name.size() + 2 >= tag.size())
        return "";
    const size_t start = from + name.size() + 3, end = tag.find(tag[start - 1], start);
    std::string value = end == std::string::npos ? "" : tag.substr(start, end - start);
    std::replace_if(value.begin(), value.end(), [](unsigned char c) { return c < ' '; }, ' ');
    return value;
}

bool has_any(const std::string &text, size_t from, size_t to, const std::initializer_list<const char *> &words)
{
    return std::any_of(words.begin(), words.end(), [&](const char *word) {
        const std::string_view part = std::string_view(text).substr(from, to - from);
        return part.find(word) != std::string_view::npos;
    });
}

} // namespace

void assimp_log::write(const char *message)
{
    std::string text(message);
    while (!text.empty() && isspace(static_cast<unsigned char>(text.back())))
        text.pop_back();
    const bool lost = std::any_of(std::begin(LOSSES), std::end(LOSSES), [&](const char *loss) { return text.find(loss) != text.npos; });
    if (text.compare(0, 4, "Warn") == 0 && !lost)
        return;
    const size_t place = text.find(" (TOK_"), end = place == text.npos ? place : text.find(')', place);
    if (end != text.npos)
        text.erase(place, end + 1 - place); /* remove the position in the file, so that equal errors are counted together */
    const size_t source = text.find(": "); /* after "Error, T0" */
    std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
    counts[source == std::string::npos ? text : text.substr(source + 2)]++;
}

void assimp_losses_of_obj(const std::string &text)
{
    size_t surfaces = 0;
    for (size_t at = 0, next; at < text.size(); at = next) {
        surfaces += text.compare(at, 5, "surf ") == 0 || text.compare(at, 5, "surf\t") == 0;
        next = text.find('\n', at);
        next = next == std::string::npos ? text.size() : next + 1;
    }
    if (surfaces > 0)
        printf("error\t%zu\tfree-form surfaces (surf) are not read: export them as polygons\n", surfaces);
}

void assimp_losses_of_dae(const std::string &text)
{
    static const char end_tag[] = "</geometry>";
    for (size_t at = 0; (at = text.find("<geometry ", at)) != std::string::npos;) {
        const size_t close = text.find('>', at), end = text.find(end_tag, at);
        if (close == std::string::npos || end == std::string::npos)
            return;
        const std::string tag = text.substr(at, close - at);
        const bool shown = has_any(text, close, end, { "<triangles", "<polylist", "<polygons", "<tristrips", "<trifans" });
        const bool lines = has_any(text, close, end, { "<lines", "<linestrips" });
        const char *kind = has_any(text, close, end, { "<convex_mesh" }) ? "convex hulls" : "splines and boundary representations";
        if (!shown && !lines && has_any(text, close, end, { "<convex_mesh", "<spline", "<brep" }))
            printf("lost\t%s\t%s\tgeometry\t\t%s are not read: export it as polygons\n",
                   attribute(tag, "id").c_str(), attribute(tag, "name").c_str(), kind);
        at = end + strlen(end_tag);
    }
}

/* Returns the name that ends at `end` in a binary FBX file. "S" and a length of four bytes precede the name. */
static std::string name_before(const std::string &bytes, size_t end)
{
    constexpr size_t MAX_NAME = 512, HEAD = 5;
    for (size_t length = 0; length < MAX_NAME && length + HEAD <= end; length++) {
        const char *head = bytes.data() + end - length - HEAD;
        uint32_t said;
        memcpy(&said, head + 1, sizeof(said));
        if (*head == 'S' && said == length + strlen("??Model")) /* two control characters and the class follow the name */
            return bytes.substr(end - length, length);
    }
    return "";
}

static void say_fbx(std::string name)
{
    std::replace_if(name.begin(), name.end(), [](unsigned char c) { return c < ' '; }, ' ');
    printf("lost\t\t%s\tmodel\t\tNURBS and patches are not read: export it as polygons\n", name.c_str());
}

void assimp_losses_of_fbx(const std::string &bytes)
{
    static const char *const kinds[] = { "NurbsSurface", "TrimNurbsSurface", "Nurb", "Patch" };
    for (const char *kind : kinds) {
        const std::string quoted = std::string("\", \"") + kind + "\"";
        for (size_t at = 0; (at = bytes.find(quoted, at)) != std::string::npos; at += quoted.size()) {
            const size_t line = bytes.rfind('\n', at) + 1, name = bytes.find("\"Model::", line);
            if (name < at)
                say_fbx(bytes.substr(name + strlen("\"Model::"), at - name - strlen("\"Model::")));
        }
        const char length[4] = { static_cast<char>(strlen(kind)), 0, 0, 0 };
        const std::string binary = std::string("\0\1ModelS", 8) + std::string(length, sizeof(length)) + kind;
        for (size_t at = 0; (at = bytes.find(binary, at)) != std::string::npos; at += binary.size())
            say_fbx(name_before(bytes, at));
    }
}
