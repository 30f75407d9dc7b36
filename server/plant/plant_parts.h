/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two files that plant_load reads. Only for the files of this folder. */
#ifndef PLANT_PLANT_PARTS_H
#define PLANT_PLANT_PARTS_H
#include "plant/plant.h"
#include "plant/yaml_reader.h"

#define PLANT_MAX_VALUE 1e30 /* of a reading or a limit: the field is computed in floats */

/* Reads plant.yaml into a plant whose path and folder are set. Findings go to diag. tags_path stays NULL if it cannot be read. */
void plant_file_read(struct plant *plant, struct diag *diag);
/* Likewise the value of its key `environment`; the folder is set. */
void plant_environments_read(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant);
/* Likewise the list `links`. */
void plant_links_read(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant);
/* An asset's `nodes`: a pattern, or a list of them. */
void plant_nodes_read(struct yaml_reader *reader, yaml_node_t *node, struct plant_asset *asset);
/* An asset's `properties`. */
void plant_properties_read(struct yaml_reader *reader, yaml_node_t *node, struct plant_asset *asset);
void plant_properties_free(struct plant_asset *asset);
bool plant_properties_same(const struct plant_asset *a, const struct plant_asset *b); /* order counts */
/* Likewise the list `sources`. */
void plant_sources_read(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant);

/* Of lists of things that begin with `char *id`. Room for the items; NULL: not a list, or too long (reported). */
void *plant_list_make(struct yaml_reader *reader, yaml_node_t *node, const char *name, int least, size_t bytes_each, int *count);
/* Reports an id that is there twice; the last thing was just read. */
void plant_list_check_id(struct yaml_reader *reader, const struct yaml_map *map, const char *what, const void *things, size_t count,
                         size_t stride, size_t line_offset);
/* Relative names are relative to the plant file. */
void plant_resolve_path(const struct plant *plant, char **path);

/* Reads plant->tags_path; assets, groups and sources are known. */
void tag_list_read(struct plant *plant, struct diag *diag);
/* The first two limits that do not rise (LL < L < H < HH; NaN: none): true, with their indices. */
bool plant_limits_wrong(const double limits[LIMIT_COUNT], int *lower, int *upper);

/* The list `colormaps` of a plant file. */
void plant_colormaps_read(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant);

#endif
