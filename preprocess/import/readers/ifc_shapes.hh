/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solids of an IFC file that web-ifc does not build as they are drawn. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_IFC_SHAPES_HH
#define PREPROCESS_IMPORT_READERS_IFC_SHAPES_HH

/* Builds pipes, surfaces of revolution and solids with curved faces and writes them as a GLB file for ifc.mjs: one node for each element,
 * named by its number, such as "#44", in metres and Y up; below it one for each item, named alike; the property "whole" says that
 * these are all that the element shows. The node "failed" has a property for
 * each item that could not be built, with the reason. `asked` is the path of a list of elements whose items are built whatever their type;
 * the file may be missing. Writes no file where there is nothing to build. Throws std::runtime_error if the file cannot be read. */
void ifc_shapes_write(const char *input, const char *output, double chord_mm, const char *asked);

#endif
