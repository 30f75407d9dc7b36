/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the statements of an IFC file (ISO 10303-21); the values of a statement are parsed on demand. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_IFC_FILE_HH
#define PREPROCESS_IMPORT_READERS_IFC_FILE_HH
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace ifc
{

/* Thrown if a statement of an IFC file is damaged, missing, or of a kind that this reader does not build. */
struct unsupported : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct value {
    enum kind_of { ABSENT, NUMBER, TEXT, NAME, REFERENCE, LIST } kind = ABSENT;
    double number = 0;
    int id = 0;              /* kind REFERENCE: id of the statement to which the value refers */
    /* kind TEXT: the text, still escaped; NAME: the name, such as ".T."; LIST with a type: the type, such as "IFCLABEL" */
    std::string text;
    std::vector<value> list; /* elements, if the value is a LIST */

    bool absent() const { return kind == ABSENT; }
    bool is(const char *name) const { return kind == NAME && text == name; }
    bool is_true() const { return is(".T."); }
};

struct entity {
    int id = 0;
    std::string type; /* type name in capitals, such as "IFCWALL" */
    std::vector<value> values;

    /* Returns the value at an index, or ABSENT if the statement has fewer values. */
    const value &operator[](size_t at) const;
    bool is(const char *name) const { return type == name; }
};

class file
{
  public:
    /* Reads the IFC file at `path` and finds its statements. Throws std::runtime_error if it cannot be read. */
    explicit file(const char *path);
    /* Returns the statement with this id. Throws unsupported if the statement is missing or damaged. */
    entity get(int id) const;
    /* Returns the statement that a value refers to. Throws unsupported if the value is no reference, or the statement is missing or
     * damaged. */
    entity get(const value &reference) const;
    /* Returns the number that a value holds, also inside a measure such as IFCPARAMETERVALUE(1.). Throws unsupported if the value is not a
     * number. */
    static double number(const value &from);
    static double number(const value &from, double otherwise);
    /* Calls f(id, type) for each statement of the file, in ascending order of ids. */
    void each(const std::function<void(int, const std::string &)> &f) const;
    /* Returns whether a statement's first value is a text. Products begin with such a text, their GUID. */
    bool is_rooted(int id) const;

  private:
    struct statement_place {
        std::string type;
        size_t at; /* byte offset in the file of the statement's opening bracket */
    };
    std::string bytes;
    std::map<int, statement_place> places;
};

} // namespace ifc

#endif
