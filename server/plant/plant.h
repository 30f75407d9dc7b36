/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant, as loaded from its plant file (YAML) and tag list (CSV) and checked for syntax and meaning. Immutable once loaded. Thread: any.
   plantcastd, plantcast-prep and plantcast-sim all use it. */
#ifndef PLANT_PLANT_H
#define PLANT_PLANT_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/text/diag.h"
#include "plant/tags/units.h"

#define PLANT_MAX_M 1e7 /* nothing is farther from the origin: plants may lie where their survey has them, 5,500 km north (UTM) */

enum interpolation {
    INTERPOLATION_SHEPARD,
    INTERPOLATION_PAPER,
    INTERPOLATION_HARMONIC,
    INTERPOLATION_FIN,
    INTERPOLATION_GP,
    INTERPOLATIONS
};
enum distance_mode { DISTANCE_GEODESIC, DISTANCE_EUCLIDEAN, DISTANCE_HEAT, DISTANCES }; /* heat: as the paper finds geodesic ones */
enum fill_mode { FILL_NONE, FILL_NEIGHBOURS };             /* may neighbours paint the place of a lost sensor? */
enum plant_show { PLANT_SHOW_VALUE, PLANT_SHOW_OPERATOR }; /* what a client begins with: readings, or their places between limits */
enum plant_start { PLANT_START_SHOWN, PLANT_START_GHOST, PLANT_START_HIDDEN }; /* an asset, until somebody asks for something else */
enum { PLANT_STARTS = 4096 }; /* of so many assets, the first, each can be hidden by itself */
enum axis { AXIS_Y, AXIS_Z }; /* which way is up */
enum data_type {
    DATA_BIT,
    DATA_INT16,
    DATA_UINT16,
    DATA_INT32,
    DATA_UINT32,
    DATA_FLOAT32,
    DATA_INT64,
    DATA_UINT64,
    DATA_FLOAT64,
    DATA_BCD /* 4 digits, one register */,
    DATA_LBCD /* 8 digits, two */
};
/* What register bytes of a value A B C D (most significant first) come in; for 64 bits likewise: CDAB reverses the registers, BADC
   the bytes of each, DCBA both. NONE: not stated. */
enum byte_order { BYTE_ORDER_NONE, BYTE_ORDER_ABCD, BYTE_ORDER_CDAB, BYTE_ORDER_BADC, BYTE_ORDER_DCBA };
enum register_table { TABLE_COIL, TABLE_DISCRETE, TABLE_INPUT, TABLE_HOLDING }; /* function codes 1, 2, 4, 3 */
enum scaling { SCALING_NONE, SCALING_LINEAR, SCALING_SQUARE_ROOT };
enum limit { LIMIT_LL, LIMIT_L, LIMIT_H, LIMIT_HH, LIMIT_COUNT };
enum alarm_mode {                 /* whose the alarms are */
                  ALARMS_DISPLAY, /* another system's: limits are watched and shown, nothing can be acknowledged here */
                  ALARMS_MIRROR,  /* likewise; its own alarm bits are read */
                  ALARMS_LOCAL    /* ours */
};
enum { ALARM_PRIORITIES = 4, ALARM_PRIORITY_DEFAULT = 2 };
extern const char *const plant_limit_names[LIMIT_COUNT];

struct plant_view { /* where a client starts looking from; plant frame, metres */
    bool set;
    double eye_m[3], target_m[3], fov_deg;
};

enum { PLANT_PROPERTIES = 32 };
struct plant_property {
    char *name, *text;
};

struct plant_asset {
    char *id, *tag, *description; /* tag defaults to id */
    char *area;                   /* of the plant, by which assets are listed; "": none */
    char *model;                  /* path, relative names resolved against the plant file's folder */
    char *nodes;                  /* patterns (nodes.h), one a line; a node that matches brings its whole sub-tree. NULL: the whole model */
    double unit_m;                /* metres per model unit, placement's scale taken in */
    enum axis up;                 /* of the model */
    double tolerance_m;           /* gaps up to this are closed when distances are found; 0: chosen from the model */
    double placement[16];         /* plant from asset frame (Z up), column-major; turns and moves only: both are in the same metres */
    enum plant_start start;
    double thickness_m;                /* of its wall; 0: not stated */
    double conductivity;               /* W/(m K) */
    double heat_transfer;              /* W/(m2 K), to what is around it */
    bool sensors_in_asset_frame;       /* X, Y, Z of its tags; else plant frame */
    struct plant_property *properties; /* of its people's own, in their order */
    size_t property_count;
    int line;
};

struct plant_alarm_settings { /* how alarms come and go */
    double deadband;          /* engineering units */
    double on_delay_s, off_delay_s;
    int priority; /* 1, the most urgent, to ALARM_PRIORITIES: of LL and HH; L and H are one less urgent */
    bool latch;   /* stays until it is reset */
};

struct plant_mirror {  /* a bit of another alarm system */
    int tag;           /* whose alarm it is, or -1 */
    int limit;         /* enum limit; LIMIT_COUNT: an alarm of no limit */
    bool acknowledged; /* the bit says that, not that the alarm is there */
};

struct plant_gp {                     /* what the interpolation `gp` is prepared with */
    double range_m, noise, deviation; /* NaN: to be fitted to readings */
    char *fit;                        /* path of a file with readings; NULL: nothing is fitted */
};

enum { PLANT_BREAKS = 16, PLANT_ISOLINES = 32 };
struct plant_group {
    char *id, *quantity, *unit;
    bool as_written; /* units: as-written; what its tags measure is taken for its unit, whatever their rows say */
    double min, max;
    double limits[LIMIT_COUNT]; /* NaN: none */
    struct plant_alarm_settings alarm_settings;
    enum interpolation interpolation;
    enum distance_mode distance;
    double strength, decay, power;
    double radius_m;   /* R of Algorithm 1; 0 = the largest distance on the asset */
    double reach_m;    /* INFINITY: no limit */
    unsigned prepared; /* bit of each interpolation that plantcast-prep computes (plant/influence.h), its own too */
    double disc_m;     /* harmonic, fin, gp: radius of the disc that each sensor is */
    double ambient;    /* fin: what is around, in its unit; NaN: not stated */
    bool directed;     /* some of its tags have a direction: it is shown with arrows */
    bool heat;         /* geodesic: heat; plantcast-prep finds distances as the paper does too */
    struct plant_gp gp;
    double hot_spot_m; /* show: blind; of hot spots, the distance at which they are down to exp(-1/2) */
    bool cuts_singles; /* singles: cut; see plant_cuts_singles */
    enum fill_mode fill;
    bool log;                    /* scale: log; min > 0 */
    double breaks[PLANT_BREAKS]; /* ascending; of bands, where somebody asks for them */
    double isolines[PLANT_ISOLINES];
    int break_count, isoline_count;
    int line;
};

enum { PLANT_COLORMAPS = 16 };
struct plant_colormap { /* out of an image */
    char *name;
    uint8_t rgb[256][3]; /* sRGB, from MIN to MAX */
};

enum transport { TRANSPORT_TCP, TRANSPORT_RTU_TCP /* RTU frames through a socket */, TRANSPORT_RTU /* a serial line */ };
enum { PLANT_HOSTS = 4 };
#define PLANT_NEVER_STALE_S 1e9
enum mqtt_payload { MQTT_NUMBER /* text: one number */, MQTT_JSON, MQTT_SPARKPLUG /* Sparkplug B */ };

struct plant_mqtt { /* how values are published to a broker; texts that are not given are NULL */
    enum mqtt_payload payload;
    int protocol;                /* 4: MQTT 3.1.1; 5 */
    bool persistent;             /* the broker keeps what is published while we are away */
    int qos, keepalive_s;
    char *client_id;
    bool has_tls;
    char *ca, *certificate, *key; /* of TLS, PEM files; ca NULL: those that the system trusts */
    char *will;                  /* topic where the broker says "offline" for us once we are gone */
    char *topic;                 /* template of the topics of tags whose address has none */
    char *value, *time, *quality; /* paths in JSON payloads */
    bool will_stays;             /* the broker keeps that for those who come later */
    bool rebirth;                /* a Sparkplug node may be asked for its birth certificate: all that is ever published */
};

enum opcua_policy { OPCUA_BEST /* of those below that the server has */, OPCUA_AES256, OPCUA_BASIC256, OPCUA_AES128, OPCUA_NONE };

struct plant_opcua { /* how an OPC UA server is reached and asked; texts that are not given are NULL */
    bool has_security;            /* stated; without, a source is refused */
    enum opcua_policy policy;     /* SignAndEncrypt, but with OPCUA_NONE */
    char *certificate, *key;      /* our own, files in PEM or DER */
    char *trusted;                /* folder: certificates and revocation lists that are believed */
    char *server_name;            /* that the server's certificate is for, if not the host */
    char *user_certificate, *user_key; /* who we are, instead of a login */
    char *path;                   /* of the URL */
    char *name_space;             /* URI of nodes whose address has none */
    int queue;                    /* values that the server keeps of each node between two messages */
    double deadband, deadband_percent; /* of changes that are told; the percentage is of EURange. 0: all */
};

struct plant_source {
    char *id, *kind; /* "modbus", "replay", "mqtt", "opcua" */
    enum transport transport;
    char *hosts[PLANT_HOSTS]; /* of one device: the next is tried where one does not answer */
    int host_count;
    char *device;                      /* of a serial line */
    int baud, parity, stop_bits;       /* parity: 'N', 'E' or 'O' */
    int port, unit;                    /* unit: Modbus unit identifier */
    int poll_ms, timeout_ms, pause_ms; /* pause: between two requests */
    int connect_delay_ms;              /* between connecting and the first request */
    bool close_between_polls;          /* one request per connection */
    int max_registers, max_bits;       /* of one request */
    int max_gap;                       /* registers or bits that nobody wants and that may be asked for none the less */
    enum byte_order byte_order;
    int address_base; /* 0 or 1: what the first register is called in plain addresses; see base_stated */
    bool base_stated;
    char *heartbeat;    /* the tag that must change, or NULL */
    int heartbeat_tag;  /* index, or -1 */
    double heartbeat_s; /* at least this often; 0: there is none */
    char *file;         /* of a replay */
    double speed;
    bool loop;
    char *login; /* file: a line with the user, one with the password */
    struct plant_mqtt mqtt;
    struct plant_opcua opcua;
    bool simulated; /* what it brings was not measured now */
    int line;
};

/* The broker that readings and alarms are published to. */
struct plant_publish {
    struct plant_source broker; /* only what says where it is, and who we are */
    char *prefix;               /* of all topics; begins with plantcast/ */
    double every_s;
};

/* Another database that history is sent to as well. */
struct plant_postgres {
    char *url;   /* of libpq, without a password; NULL: there is none */
    char *login; /* a file with the user and the password, a line each; NULL: as libpq finds them */
    char *schema;
    double spool_points; /* at most so many wait for it on this machine's disk */
};

struct plant_history {
    bool off;
    char *folder; /* NULL: plant_history_folder says */
    double keep_days, keep_gb;
    double deadband_percent; /* of a tag's span, where it has no deadband of its own */
    double override_s;       /* a point is kept at least this often */
    struct plant_postgres postgres;
};

/* A raw value that says "no sensor": as bits, or as a number. */
struct plant_sentinel {
    bool is_bits;
    uint64_t bits;
    double number;
};

/* Another tag that says whether this one may be believed: if ((value & mask) == want) != negate. */
struct plant_quality_tag {
    int tag;             /* index */
    uint64_t mask, want; /* mask 0: there is none */
    bool negate;
};

enum { PLANT_SENTINELS = 4 };
struct plant_tag {
    char *name, *description;
    char *unit;                /* of its readings, limits and deadbands: its group's, else as the row says */
    char *own_unit;            /* of what its address gives, and of scaled_low and scaled_high: as the row says, else unit */
    struct unit_change change; /* from own_unit to unit */
    int source, group, asset;  /* index, or -1 */
    char *lost_asset;          /* the id of an asset that is not there (plant_load_with_orphans), or NULL */
    bool place_assumed;        /* Place: equipment. It is somewhere on its asset, and stands for all of it (field/field.h) */
    char *address;             /* as written: of a register, the name of a series, a topic, or = and an expression */
    char *topic, *path;        /* of an MQTT source: the topic whole, and where in its payload ("": the source's way); else NULL. Of
                                  Sparkplug: GROUP/NODE[/DEVICE], and the metric. Of OPC UA: the URI of the namespace, and s=NAME, say */
    int element;               /* of an array of OPC UA; -1: it is none */
    int modbus_unit;           /* -1: the source's */
    enum register_table table;
    int register_index; /* from 0, as on the wire */
    int bit;            /* bit of a register, or -1 */
    enum data_type type;
    enum byte_order byte_order; /* resolved for 32 and 64 bits. 16 bits: as the row says, else NONE (the standard); bits: NONE */
    int scan_ms;                /* 0: the source's poll_ms */
    enum scaling scaling;
    double raw_low, raw_high, scaled_low, scaled_high; /* scaled: in own_unit */
    bool has_range;                                    /* scaled_low to scaled_high is what the instrument can measure */
    bool ne43;                                         /* raw_low and raw_high are 4 and 20 mA, and NAMUR NE 43 says what is beyond */
    struct plant_sentinel sentinels[PLANT_SENTINELS];
    int sentinel_count;
    bool negate;
    bool has_position;             /* position_m is set; else see node */
    double position_m[3];          /* in the frame that the asset states */
    char *node;                    /* name of the model node whose place this is, or NULL */
    double strength, decay;        /* resolved: own, else the group's */
    double stale_s;                /* resolved; default 3 polls, at least 5 s */
    double flatline_s;             /* a value that has not changed for so long is doubted; 0: never */
    bool states_stale;             /* in its row */
    struct expression *expression; /* of a derived tag: what its value is; else NULL */
    struct plant_quality_tag quality;
    double limits[LIMIT_COUNT];                 /* resolved: own, else the group's; NaN: none */
    double deadband;                            /* history is within this of what was read; NaN: the plant's history says */
    struct plant_alarm_settings alarm_settings; /* resolved: own, else the group's */
    int suppressed_by;                          /* while this tag, a bit, is 1, by design; -1: none */
    struct plant_mirror mirror;
    int direction[3];    /* tags that say where its value points: components along X, Y and Z of the plant, or a bearing */
    int direction_count; /* 0: it has no direction; 1: a bearing, degrees; 3 */
    int line, column; /* of its name in the tag list */
};

enum { PLANT_ENVIRONMENTS = 8 };
struct plant_environment { /* pictures of surroundings, to light the plant with */
    char *name;            /* of the file, without its ending; never "sky" */
    char *path;
};

enum { PLANT_LINKS = 16 };
struct plant_link { /* where else one reads about an asset, or a tag */
    char *name;
    char *url; /* http or https; what is in braces is put in, escaped (PLANT.md) */
    bool of_tags;
};

struct plant_conversion { /* a model that plantcast-prep makes by another program */
    char *model;          /* the glTF file that is made */
    char *from, *command; /* out of which file, and by what */
    double timeout_s;
    int line;
};

struct plant {
    char *path, *folder; /* of the plant file; folder without trailing slash */
    char *tags_path;
    char hash[17];          /* of both files, hexadecimal: which configuration this is */
    bool keeps_orphans;     /* while it is loaded: tags of assets that are not there are no error */
    bool without_models;    /* likewise: nor are models that are not there */
    char *name, *time_zone; /* IANA name; default UTC */
    enum axis up;           /* of the plant frame */
    struct plant_view view;
    enum plant_show show;
    struct plant_environment environments[PLANT_ENVIRONMENTS]; /* the first is shown where nobody asks for another */
    size_t environment_count;
    struct plant_link links[PLANT_LINKS];
    size_t link_count;
    struct plant_conversion *conversions;
    size_t conversion_count;
    struct plant_history history;
    enum alarm_mode alarms;
    struct named_view *views;    /* plant/walls/wall.h, as the next three */
    struct tour *tours;
    struct other_plant *other_plants;
    struct wall *walls;
    size_t view_count, tour_count, other_plant_count, wall_count;
    struct plant_publish *publish; /* NULL: nothing is published */
    struct plant_notify *notify; /* recipients of alarms (plant/sections/notification.h); NULL: none */
    struct plant_asset *assets;
    struct plant_group *groups;
    struct plant_source *sources;
    struct plant_tag *tags;
    size_t asset_count, group_count, source_count, tag_count;
    struct plant_colormap colormaps[PLANT_COLORMAPS];
    size_t colormap_count;
    int *assets_by_id, *tags_by_name; /* indices, sorted by id, by name. assets_by_id: NULL until all is read */
    int *derived;                     /* of tags with an expression, each after those that it is computed from */
    size_t derived_count;
};

/* Loads a plant file and its tag list. Findings go to diag. Returns NULL if there was any error. */
struct plant *plant_load(const char *path, struct diag *diag);
struct plant *plant_load_or_print(const char *path); /* the same; prints findings to standard error */
/* The same, for what needs no models: those that are not there are no error. */
struct plant *plant_load_without_models(const char *path);
/* The same as plant_load, but accepts tags that name an asset that does not exist: they have no asset, and lost_asset is set. */
struct plant *plant_load_with_orphans(const char *path, struct diag *diag);
void plant_destroy(struct plant **plant); /* &NULL is fine; leaves NULL */

int plant_find_asset(const struct plant *plant, const char *id); /* returns an index or -1, as all below */
int plant_find_group(const struct plant *plant, const char *id);
int plant_find_environment(const struct plant *plant, const char *name); /* 0: "sky", 1: the first of the plant's own, ... */
int plant_find_tag(const struct plant *plant, const char *name);
/* Returns whether readings of a tag are simulated: its source is, or that of a tag that it is computed from. */
bool plant_tag_simulated(const struct plant *plant, int tag);
/* Returns the folder of the prepared asset files: FOLDER/NAME.prepared beside NAME.yaml. Free with mem_free(). */
char *plant_prepared_folder(const struct plant *plant);
char *plant_history_folder(const struct plant *plant); /* likewise of the history, unless the plant file names another one */

#endif
