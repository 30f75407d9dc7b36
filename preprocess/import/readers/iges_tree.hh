/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts the entity tree of an IGES file to an XCAF assembly, the form into which Open CASCADE reads STEP files. */
#ifndef PREPROCESS_IMPORT_READERS_IGES_TREE_HH
#define PREPROCESS_IMPORT_READERS_IGES_TREE_HH
#include <IGESControl_Reader.hxx>
#include <TDocStd_Document.hxx>

#include <string>

#include "preprocess/import/readers/reader.hh"

/* Adds the file that `iges` has read to the document, with names, colours and layers. Groups and subfigures become assemblies, instances of
 * a subfigure become placements of its part, solids and the loose surfaces of a group become parts. Shapes are repaired part by part
 * afterwards: if Open CASCADE repaired them during transfer (read.iges.sequence), the tree could not find the shape of an entity. Names and
 * layers are converted from `encoding`. Throws what Open CASCADE throws. */
void iges_tree_add(IGESControl_Reader &iges, const Handle(TDocStd_Document) & document, const struct text_encoding &encoding);
/* Returns the name of the length unit that the IGES file states, or "" if it states none. */
std::string iges_units(IGESControl_Reader &iges);

#endif
