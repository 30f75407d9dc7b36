/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions shared by the files that read the plant file and the tag list. Private to plant/. Call from one thread only. The
   functions that read a key get the plant as void *, because struct yaml_key requires this type. */
#ifndef PLANT_PLANT_IMPL_H
#define PLANT_PLANT_IMPL_H
#include "plant/parse/yaml_reader.h"
#include "plant/plant.h"

#define PLANT_MAX_VALUE 1e30 /* maximum absolute value of a reading or a limit, because interpolated values are computed as float */

/* Reads the plant file into a plant whose path and folder are set. Errors and warnings go to diag. tags_path stays NULL if the
   plant file names no readable tag list. */
void plant_file_read(struct plant *plant, struct diag *diag);
/* Reads the value of the key `environment`; the plant's folder must be set. */
void plant_environments_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
/* Reads the list `convert`. */
void plant_conversions_read(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant);
/* Reads the list `links`. */
void plant_links_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
/* Reads the key `notify`. */
void plant_notify_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
/* Frees the settings of `notify` and sets *notify to NULL; accepts a pointer to NULL. */
void plant_notify_free(struct plant_notify **notify);
/* Reads a daily time span such as 22:00-06:00; *from_min and *to_min receive minutes after midnight. Returns false after an
   error, which is reported for the key `name`. */
bool plant_day_span_read(struct yaml_reader *reader, yaml_node_t *node, const char *name, int *from_min, int *to_min);
/* Each function reads one list of the plant file: `views`, `tours`, `other_plants` or `walls`. */
void plant_views_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
void plant_tours_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
void plant_other_plants_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
void plant_walls_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
/* Reads a group's key `prepare`, a list of interpolations (plant/influence.h). */
void plant_influence_read(struct yaml_reader *reader, yaml_node_t *node, void *record);
/* plant_gp_read() reads a group's key `gp`; plant_gp_check() checks the values and sets defaults. */
void plant_gp_read(struct yaml_reader *reader, yaml_node_t *node, void *group);
void plant_gp_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_group *group);
/* Reports missing keys that the interpolation `fin` needs: the temperature of a group's surroundings (`ambient`), and the wall thickness of
   assets with sensors of that group. */
void plant_influence_check(const struct plant *plant, struct diag *diag);
/* Both functions report names in tours and in panes of walls for which the plant file or tag list has no view, tag, tour or
   other plant. Call them after the tag list has been read. */
void plant_tours_check(const struct plant *plant, struct diag *diag);
void plant_walls_check(const struct plant *plant, struct diag *diag);
void plant_views_free(struct plant *plant);
void plant_tours_free(struct plant *plant);
void plant_other_plants_free(struct plant *plant);
void plant_walls_free(struct plant *plant);
/* Reads an asset's key `nodes`: one pattern, or a list of patterns. */
void plant_nodes_read(struct yaml_reader *reader, yaml_node_t *node, struct plant_asset *asset);
/* Reads an asset's `properties`. */
void plant_properties_read(struct yaml_reader *reader, yaml_node_t *node, struct plant_asset *asset);
void plant_properties_free(struct plant_asset *asset);
/* Returns whether two assets have the same properties in the same order. */
bool plant_properties_same(const struct plant_asset *a, const struct plant_asset *b);
/* Reads the key `postgres` of the plant file's `history` into a struct plant_history. */
void plant_postgres_read(struct yaml_reader *reader, yaml_node_t *node, void *history);
/* Checks that the login file of `postgres` can be read; the plant's folder must be set. */
void plant_postgres_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant,
                          struct plant_postgres *postgres);
void plant_postgres_finish(struct plant_postgres *postgres);
/* Reads the key `publish`. */
void plant_publish_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);
void plant_publish_free(struct plant_publish **publish); /* Frees the settings and sets *publish to NULL; accepts a pointer to NULL. */
/* Reads the list `sources`. */
void plant_sources_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);

/* Reads the key `tls` of an MQTT source: certificates and keys. */
void plant_mqtt_read_tls(struct yaml_reader *reader, yaml_node_t *node, void *source);
/* Checks the keys of an MQTT source, and sets defaults. */
void plant_mqtt_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_source *source);
void plant_mqtt_finish(struct plant_mqtt *mqtt);
/* Functions for a source of type opcua: they read the key `security`, check all keys of the source, and free its settings. */
void plant_opcua_read_security(struct yaml_reader *reader, yaml_node_t *node, void *source);
void plant_opcua_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, struct plant_source *source);
void plant_opcua_finish(struct plant_opcua *opcua);
/* Resolves the path of a file or folder with secrets (a key or a password) relative to the plant file. If the file cannot be
   read, warns, naming the key. This is not an error, since a user who only prepares the plant may lack the right to read the
   file. */
void plant_secret_check(struct yaml_reader *reader, const struct yaml_map *map, const struct plant *plant, const char *key, char **path);

/* Prepares reading a YAML list into records that begin with `char *id`: allocates a record for each item of the list and sets
   *count. Reports a list with fewer than `least` items, or with more than `most`, of which only the first `most` are read. Returns
   NULL, reported, if the node is not a list or memory runs out. */
void *plant_list_make(struct yaml_reader *reader, yaml_node_t *node, const char *name, int least, int most, size_t bytes_each,
                      int *count);
/* Returns the number of items of a YAML list, but at most `most`; reports a longer list. Returns -1, reported, if the node is not a
   list. */
int plant_list_count(struct yaml_reader *reader, yaml_node_t *node, const char *name, int most);
/* Reports an error if an earlier record of the list has the same id as the record read last. */
void plant_list_check_id(struct yaml_reader *reader, const struct yaml_map *map, const char *what, const void *things, size_t count,
                         size_t stride, size_t line_offset);
/* Puts the folder of the plant file before *path if *path is relative. */
void plant_resolve_path(const struct plant *plant, char **path);

/* Reads the tag list, plant->tags_path; assets, groups and sources must have been read. */
void tag_list_read(struct plant *plant, struct diag *diag);
/* Returns true if alarm limits do not ascend (LL < L < H < HH; NaN: not set). The indices of the first two wrong limits are then set. */
bool plant_limits_wrong(const double limits[LIMIT_COUNT], int *lower, int *upper);

/* Reads the list `colormaps`. */
void plant_colormaps_read(struct yaml_reader *reader, yaml_node_t *node, void *plant);

#endif
