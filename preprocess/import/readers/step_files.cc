/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Copies STEP files so that Open CASCADE can read assemblies of several files. Open CASCADE opens an external file only by its
 * exact name in the main file's folder, and only if it is declared as AP203 or AP214. So the copies get simple names and refer
 * to each other by these names. */
#include "preprocess/import/readers/step_files.hh"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "preprocess/import/readers/reader.hh"

namespace
{

constexpr char MARK[] = "`|";
constexpr size_t MOST_FILES = 5000;
constexpr size_t MOST_BEFORE = 1000; /* number of bytes searched for the keyword at the start of a STEP statement */

struct preparing {
    std::string main;           /* path of the main file */
    std::string copies, beside; /* folders of the copies, and of links to the files next to the main file */
    const char *asked;
    step_files out;
    /* file names of the copies, by path of the original; if the original is missing, by its name in the model */
    std::map<std::string, std::string> names;
    std::vector<std::string> open; /* paths of external files that are not copied yet */
};

std::string lower(std::string text)
{
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(tolower(c)); });
    return text;
}

bool ends_with(const std::string &text, const std::string &end)
{
    return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/* Returns whether this is the name of a STEP file. Compressed files are not read, but must be named if they are missing. */
bool is_step_name(const std::string &name)
{
    const std::string small = lower(name);
    for (const char *ending : { ".stp", ".step", ".p21", ".stpz", ".stp.gz", ".step.gz", ".p21.gz" })
        if (ends_with(small, ending))
            return true;
    return false;
}

void add_utf8(std::string *out, unsigned long code)
{
    if (code < 0x80) {
        *out += static_cast<char>(code);
    } else if (code < 0x800) {
        *out += static_cast<char>(0xc0 | code >> 6);
        *out += static_cast<char>(0x80 | (code & 0x3f));
    } else {
        *out += static_cast<char>(0xe0 | code >> 12);
        *out += static_cast<char>(0x80 | (code >> 6 & 0x3f));
        *out += static_cast<char>(0x80 | (code & 0x3f));
    }
}

/* Decodes the escapes \X\HH, \X2\HHHH...\X0\ and \S\C of ISO 10303-21. */
std::string without_escapes(const std::string &text)
{
    std::string out;
    for (size_t i = 0; i < text.size(); i++) {
        size_t end = text.compare(i, 4, "\\X2\\") == 0 ? text.find("\\X0\\", i) : std::string::npos;
        if (end != std::string::npos) {
            for (i += 4; i + 4 <= end; i += 4)
                add_utf8(&out, strtoul(text.substr(i, 4).c_str(), nullptr, 16));
            i = end + 3;
        } else if (text.compare(i, 3, "\\X\\") == 0) {
            add_utf8(&out, strtoul(text.substr(i + 3, 2).c_str(), nullptr, 16));
            i += 4;
        } else if (text.compare(i, 3, "\\S\\") == 0 && i + 3 < text.size()) {
            add_utf8(&out, static_cast<unsigned char>(text[i + 3]) | 0x80UL);
            i += 3;
        } else {
            out += text[i];
        }
    }
    return out;
}

std::string base_name(const std::string &path)
{
    return path.substr(path.find_last_of("/\\") == std::string::npos ? 0 : path.find_last_of("/\\") + 1);
}

std::string real_path(const std::string &path)
{
    char *real = access(path.c_str(), R_OK) == 0 ? realpath(path.c_str(), nullptr) : nullptr;
    const std::string out = real ? real : "";
    free(real);
    return out;
}

/* Finds an external file named in a STEP file in the model's folder by the links that child_paths_link_beside() made: first by its
 * exact name, then ignoring case. Returns its path, or "" if there is none. */
std::string find_beside(const preparing &p, const std::string &named)
{
    const std::string base = base_name(named), main = base_name(p.main);
    if (base == main)
        return p.main;
    std::string path = real_path(p.beside + base);
    if (path.empty() && lower(base) != lower(main))
        path = real_path(p.beside + lower(base));
    return (path.empty() && lower(base) == lower(main)) || path == real_path(p.main) ? p.main : path;
}

/* Returns the name by which the copies refer to an external file, and adds the file to the list of files to copy. */
std::string external_name(preparing *p, const std::string &literal)
{
    const std::string named = without_escapes(literal), path = find_beside(*p, named), &known = path.empty() ? named : path;
    auto entry = p->names.find(known);
    if (entry != p->names.end())
        return entry->second;
    if (p->names.size() >= MOST_FILES)
        refuse("the STEP file refers to more than %zu other files, the most that Plantcast supports", MOST_FILES);
    const std::string copy = "external_" + std::to_string(p->names.size()) + ".stp";
    p->names[known] = copy;
    p->out.externals[copy] = { named, !path.empty() };
    if (!path.empty())
        p->open.push_back(path);
    return copy;
}

bool names_files(const std::string &statement)
{
    for (const char *keyword : { "DOCUMENT_FILE", "DOCUMENT(", "EXTERNAL_SOURCE", "EXTERNAL_IDENTIFICATION_ASSIGNMENT" })
        if (statement.find(keyword) != std::string::npos)
            return true;
    return false;
}

/* Converts a quoted string (a file name, a data format or a name) for the copy of a STEP file. before: text of the copy before
 * the string. statement: offset in `before` at which the string's statement begins. */
std::string converted_string(preparing *p, const std::string &before, size_t statement, const std::string &text)
{
    if (is_step_name(text) && names_files(before.substr(statement, MOST_BEFORE)))
        return external_name(p, text);
    if (text.compare(0, 5, "STEP ") == 0 && before.substr(statement, MOST_BEFORE).find("'data format'") != std::string::npos)
        return "STEP AP214";
    bool plain = std::none_of(text.begin(), text.end(), [](unsigned char c) { return c >= 0x80 || c == '\\'; });
    return plain ? text : text + MARK;
}

/* Returns the text of a STEP file with all strings converted by converted_string(). */
std::string converted_text(preparing *p, const std::string &text)
{
    std::string out;
    size_t statement = 0; /* offset in `out` at which the current statement begins */
    for (size_t i = 0; i < text.size(); i++) {
        size_t comment = text.compare(i, 2, "/*") == 0 ? text.find("*/", i + 2) : std::string::npos;
        size_t end = i;
        while (text[i] == '\'' && (end = text.find('\'', end + 1)) != std::string::npos && text.compare(end, 2, "''") == 0)
            end++;
        if (comment != std::string::npos) {
            out.append(text, i, comment + 2 - i);
            i = comment + 1;
        } else if (text[i] == '\'' && end != std::string::npos) {
            out += "'" + converted_string(p, out, statement, text.substr(i + 1, end - i - 1)) + "'";
            i = end;
        } else {
            out += text[i];
            if (text[i] == ';')
                statement = out.size();
        }
    }
    return out;
}

void write_copy(preparing *p, const std::string &path, const std::string &text)
{
    FILE *file = fopen(path.c_str(), "wb");
    bool good = file && fwrite(text.data(), 1, text.size(), file) == text.size();
    if (file && fclose(file) != 0)
        good = false;
    if (!good)
        refuse("%s", strerror(errno));
    p->out.copies.push_back(path);
}

std::string utf8_of(const std::string &path, const char *asked, bool say)
{
    const std::string text = read_whole(path.c_str());
    text_encoding encoding;
    encoding.choose(text, asked, "");
    if (say)
        encoding.say();
    return encoding.utf8(text);
}

} // namespace

step_files step_files_prepare(const std::string &path, const std::string &folder, const char *asked)
{
    preparing p = { path, folder, folder + "beside/", asked, {}, {}, {} };
    const std::string text = read_whole(path.c_str());
    p.names[path] = "external_0.stp"; /* name of the main file's copy; files that refer to the main file use this name */
    const std::string converted = converted_text(&p, utf8_of(path, asked, true));
    p.out.main = path;
    if (converted != text) {
        p.out.main = folder + "external_0.stp";
        write_copy(&p, p.out.main, converted);
    }
    while (!p.open.empty()) {
        const std::string next = p.open.back();
        p.open.pop_back();
        write_copy(&p, folder + p.names[next], converted_text(&p, utf8_of(next, asked, false)));
    }
    return p.out;
}

std::string step_name_without_mark(std::string name)
{
    if (ends_with(name, MARK))
        name.resize(name.size() - strlen(MARK));
    return name;
}
