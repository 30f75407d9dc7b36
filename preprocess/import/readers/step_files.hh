/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares copies of STEP files for Open CASCADE: names in UTF-8, and references to external files rewritten to the names of their copies.
 * Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_STEP_FILES_HH
#define PREPROCESS_IMPORT_READERS_STEP_FILES_HH
#include <map>
#include <string>
#include <vector>

struct step_external {
    std::string named; /* name of the external file as the STEP file that refers to it states it */
    bool found;
};

struct step_files {
    std::string main;                               /* path of the STEP file to read: that of the original file, or of its copy */
    std::map<std::string, step_external> externals; /* external files, by the name that copies use for them, such as "external_1.stp" */
    std::vector<std::string> copies;                /* paths to remove after reading */
};

/* Prepares a STEP file and all STEP files that it refers to, if the folder `beside` in `folder` has links to them. Writes copies into
 * `folder`. Prints the encoding of the names. asked: the encoding that the user stated, or "-". Calls refuse() if a file cannot be
 * read. */
step_files step_files_prepare(const std::string &path, const std::string &folder, const char *asked);

/* Returns the name without the mark at its end. Open CASCADE would read a name whose last character is not ASCII as an empty name, so
 * copies have such names with a mark after them. */
std::string step_name_without_mark(std::string name);

#endif
