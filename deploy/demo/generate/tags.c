/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tag table. */
#include "tags.h"

#include "base/mem.h"

struct row {
    const char *name, *asset, *part;
    double x, y, z;
    enum tag_kind kind;
    bool node;
    double value, band;
    const char *loop, *description;
};

#define T TAG_TEMPERATURE
#define P TAG_PRESSURE
#define V TAG_VIBRATION
#define SADDLES "saddles and nozzles"

static const struct row rows[] = {
    /* Feed / bottoms exchanger: hot bottoms through the shell from the north, cold feed through the tubes. */
    { "TE-101", "E-101", "shell", 1.9, -0.35, 2.15, T, true, 158.0, 12, "reboiler", "E-101 shell, hot end" },
    { "TE-102", "E-101", "shell", 0.75, -0.60, 1.70, T, true, 141.0, 12, "bottoms", "E-101 shell, second pass" },
    { "TE-103", "E-101", "shell", -0.65, -0.60, 1.70, T, true, 119.0, 12, "bottoms", "E-101 shell, third pass" },
    { "TE-104", "E-101", "shell", -1.95, -0.35, 1.10, T, true, 97.0, 12, "bottoms", "E-101 shell, cold end" },
    { "TE-105", "E-101", "heads", -3.15, -0.50, 1.90, T, true, 68.0, 10, "preheat", "E-101 channel" },
    { "PT-101", "E-101", SADDLES, 2.17, -0.11, 2.27, P, false, 9.4, 1.2, "bottoms", "E-101 shell inlet" },
    { "PT-102", "E-101", SADDLES, -2.17, -0.11, 0.95, P, false, 8.9, 1.2, "bottoms", "E-101 shell outlet" },
    { "PT-103", "E-101", SADDLES, -3.1, -0.11, 2.20, P, false, 10.6, 1.2, "feed", "E-101 feed outlet" },
    /* Reboiler: boiling shell, steam in the bundle. */
    { "TE-111", "E-102", "heads", -3.45, -0.3, 1.70, T, true, 178.0, 6, "steam", "E-102 steam channel" },
    { "TE-112", "E-102", "shell", -2.2, -0.6, 1.65, T, false, 170.0, 8, "reboiler", "E-102 cone" },
    { "TE-113", "E-102", "shell", -1.1, -0.8, 1.75, T, true, 168.5, 8, "reboiler", "E-102 boiling side, channel end" },
    { "TE-114", "E-102", "shell", 0.4, -0.8, 1.85, T, true, 166.5, 8, "reboiler", "E-102 boiling side, middle" },
    { "TE-115", "E-102", "shell", 2.0, -0.4, 1.75, T, false, 165.0, 8, "reboiler", "E-102 behind the weir" },
    { "PT-111", "E-102", "shell", 0.6, -0.3, 2.55, P, true, 7.4, 1, "reboiler", "E-102 vapour space" },
    { "PT-112", "E-102", "heads", -3.5, 0.0, 1.85, P, false, 9.6, 1.0, "steam", "E-102 steam" },
    /* Trim condenser: vapour in the shell, cooling water in the tubes. */
    { "TE-116", "E-103", "shell", 1.45, -0.3, 8.65, T, true, 51.5, 8, "condenser", "E-103 shell inlet" },
    { "TE-117", "E-103", "shell", 0.0, -0.46, 8.35, T, false, 45.0, 8, "condenser", "E-103 shell, middle" },
    { "TE-118", "E-103", "shell", -1.45, -0.3, 7.95, T, true, 40.0, 6, "condenser", "E-103 shell outlet" },
    { "TE-119", "E-103", "heads", -2.5, -0.4, 8.45, T, true, 31.0, 15, "cooling", "E-103 water channel" },
    { "PT-116", "E-103", "shell", 1.0, 0.0, 8.85, P, true, 6.2, 0.7, "condenser", "E-103 shell" },
    { "PT-117", "E-103", "heads", -2.5, 0.3, 8.45, P, false, 3.6, 0.6, "water", "E-103 water" },
    /* Product coolers. */
    { "TE-121", "E-104", "shell", 1.4, -0.3, 1.65, T, true, 90.0, 10, "bottoms", "E-104 shell inlet" },
    { "TE-122", "E-104", "shell", 0.0, -0.45, 1.35, T, false, 66.0, 14, "product", "E-104 shell, middle" },
    { "TE-123", "E-104", "shell", -1.4, -0.3, 0.95, T, true, 46.0, 14, "product", "E-104 shell outlet" },
    { "TE-124", "E-104", "heads", -2.35, -0.38, 1.35, T, true, 33.0, 15, "cooling", "E-104 water channel" },
    { "PT-121", "E-104", "shell", 1.0, -0.2, 1.75, P, false, 8.3, 1.0, "bottoms", "E-104 shell" },
    { "PT-122", "E-104", "heads", -2.35, 0.2, 1.65, P, false, 3.7, 0.6, "water", "E-104 water" },
    { "TE-126", "E-105", "shell", 1.4, -0.3, 1.65, T, true, 39.5, 15, "reflux", "E-105 shell inlet" },
    { "TE-127", "E-105", "shell", 0.0, -0.45, 1.35, T, false, 35.0, 15, "reflux", "E-105 shell, middle" },
    { "TE-128", "E-105", "shell", -1.4, -0.3, 0.95, T, true, 31.5, 15, "drum", "E-105 shell outlet" },
    { "TE-129", "E-105", "heads", -2.35, -0.38, 1.35, T, false, 28.0, 15, "cooling", "E-105 water channel" },
    { "PT-126", "E-105", "shell", 1.0, -0.2, 1.75, P, false, 9.8, 1.2, "distillate", "E-105 shell" },
    { "PT-127", "E-105", "heads", -2.35, 0.2, 1.65, P, false, 3.7, 0.6, "water", "E-105 water" },
    /* Air cooler: inlet headers south, outlet headers north. */
    { "TE-131", "EA-101", "headers", -2.2, -3.3, 2.5, T, true, 69.0, 15, "column", "EA-101 west bay, inlet header" },
    { "TE-132", "EA-101", "headers", 2.2, -3.3, 2.5, T, true, 69.0, 15, "column", "EA-101 east bay, inlet header" },
    { "TE-133", "EA-101", "headers", -2.2, 3.3, 2.5, T, true, 52.5, 6, "fans", "EA-101 west bay, outlet header" },
    { "TE-134", "EA-101", "headers", 2.2, 3.3, 2.5, T, true, 51.0, 6, "fans", "EA-101 east bay, outlet header" },
    { "TE-135", "EA-101", "tubes", -2.2, 0.0, 2.7, T, false, 60.0, 8, "fans", "EA-101 west bay, tubes" },
    { "TE-136", "EA-101", "tubes", 2.2, 0.0, 2.7, T, false, 59.0, 8, "fans", "EA-101 east bay, tubes" },
    { "PT-131", "EA-101", "headers", -1.5, -3.3, 2.6, P, false, 6.5, 0.7, "overhead", "EA-101 inlet, west bay" },
    { "PT-132", "EA-101", "headers", 2.9, -3.3, 2.6, P, false, 6.5, 0.7, "overhead", "EA-101 inlet, east bay" },
    { "VT-131", "EA-101", "fan rings", -2.2, -3.3, 1.4, V, false, 2.4, 0, "EA-101", "EA-101 fan A" },
    { "VT-132", "EA-101", "fan rings", -2.2, 3.3, 1.4, V, false, 2.8, 0, "EA-101", "EA-101 fan B" },
    { "VT-133", "EA-101", "fan rings", 2.2, -3.3, 1.4, V, false, 2.1, 0, "EA-101", "EA-101 fan C" },
    { "VT-134", "EA-101", "fan rings", 2.2, 3.3, 1.4, V, false, 2.6, 0, "EA-101", "EA-101 fan D" },
    /* Column, bottom to top. */
    { "TE-141", "T-101", "shell", -0.5, -0.7, 3.2, T, true, 165.0, 8, "reboiler", "T-101 bottoms" },
    { "TE-142", "T-101", "shell", -0.6, -0.6, 5.2, T, false, 158.0, 15, "column", "T-101 tray 28" },
    { "TE-143", "T-101", "shell", -0.5, -0.7, 7.4, T, true, 143.0, 15, "column", "T-101 tray 23" },
    { "TE-144", "T-101", "shell", -0.6, -0.6, 9.5, T, false, 124.0, 15, "column", "T-101 tray 18" },
    { "TE-145", "T-101", "shell", 0.3, -0.8, 10.7, T, false, 107.0, 15, "column", "T-101 feed tray 15" },
    { "TE-146", "T-101", "shell", -0.5, -0.7, 12.6, T, true, 97.0, 15, "column", "T-101 tray 10" },
    { "TE-147", "T-101", "shell", -0.6, -0.6, 15.0, T, false, 86.0, 15, "column", "T-101 tray 6" },
    { "TE-148", "T-101", "shell", -0.5, -0.7, 17.5, T, true, 77.0, 15, "column", "T-101 tray 2" },
    { "TE-149", "T-101", "shell", 0.2, -0.4, 20.3, T, true, 71.0, 15, "column", "T-101 top" },
    { "PT-141", "T-101", "shell", -0.8, -0.2, 4.2, P, false, 7.3, 1.4, "column", "T-101 bottom" },
    { "PT-142", "T-101", "shell", 0.5, -0.7, 12.9, P, true, 7.0, 1.4, "column", "T-101 middle" },
    { "PT-143", "T-101", "shell", 0.5, -0.7, 19.4, P, false, 6.7, 0.7, "overhead", "T-101 top" },
    /* Drums. */
    { "TE-151", "V-101", "shell", -1.9, -0.6, 5.60, T, true, 40.0, 15, "drum", "V-101 inlet end" },
    { "TE-152", "V-101", "shell", 0.2, -0.8, 4.90, T, true, 39.5, 15, "drum", "V-101 liquid" },
    { "TE-153", "V-101", "shell", 2.2, -0.3, 5.50, T, false, 39.0, 15, "drum", "V-101 vapour end" },
    { "PT-151", "V-101", "shell", -0.6, -0.3, 6.00, P, true, 5.9, 1.4, "drum", "V-101" },
    { "TE-156", "V-102", "shell", -0.3, -0.6, 4.2, T, true, 38.0, 15, "offgas", "V-102 vapour" },
    { "TE-157", "V-102", "shell", -0.5, -0.4, 1.8, T, false, 36.5, 15, "offgas", "V-102 liquid" },
    { "PT-156", "V-102", "shell", 0.5, -0.4, 4.5, P, true, 5.6, 1.4, "offgas", "V-102" },
    /* Compressor train. */
    { "TE-161", "K-101", "casing", -2.1, -0.2, 1.6, T, true, 61.0, 12, "K-101", "K-101 compressor bearing, outboard" },
    { "TE-162", "K-101", "casing", -0.6, -0.2, 1.6, T, true, 66.0, 12, "K-101", "K-101 compressor bearing, inboard" },
    { "TE-163", "K-101", "gear", 0.3, -0.4, 1.75, T, true, 72.0, 12, "K-101", "K-101 gear" },
    { "TE-164", "K-101", "motor", 1.15, -0.5, 1.6, T, true, 63.0, 12, "K-101", "K-101 motor bearing, drive end" },
    { "TE-165", "K-101", "motor", 2.2, -0.5, 1.6, T, false, 58.0, 12, "K-101", "K-101 motor bearing, other end" },
    { "TE-166", "K-101", "casing", -1.1, -0.5, 1.7, T, false, 96.0, 15, "offgas", "K-101 discharge side" },
    { "TE-167", "K-101", "casing", -1.7, -0.5, 1.6, T, false, 47.0, 15, "offgas", "K-101 suction side" },
    { "TE-168", "K-101", "motor", 1.6, -0.5, 1.3, TAG_WINDING, false, 92.0, 20, "K-101", "K-101 motor winding" },
    { "PT-161", "K-101", "casing", -1.68, -0.08, 2.1, P, false, 5.5, 1.4, "offgas", "K-101 suction" },
    { "PT-162", "K-101", "casing", -1.10, -0.08, 2.1, P, false, 13.8, 1.4, "offgas", "K-101 discharge" },
    { "VT-161", "K-101", "casing", -2.15, 0.0, 1.7, V, true, 2.6, 0, "K-101", "K-101 compressor, outboard" },
    { "VT-162", "K-101", "casing", -0.6, 0.0, 1.7, V, true, 3.1, 0, "K-101", "K-101 compressor, inboard" },
    { "VT-163", "K-101", "gear", 0.0, 0.0, 1.8, V, true, 3.8, 0, "K-101", "K-101 gear, high speed" },
    { "VT-164", "K-101", "gear", 0.6, 0.3, 1.7, V, false, 2.9, 0, "K-101", "K-101 gear, low speed" },
    { "VT-165", "K-101", "motor", 1.15, 0.0, 2.05, V, true, 1.9, 0, "K-101", "K-101 motor, drive end" },
    { "VT-166", "K-101", "motor", 2.3, 0.0, 1.95, V, false, 1.5, 0, "K-101", "K-101 motor, other end" },
    /* Tanks. */
    { "TE-171", "TK-101", "shell", -2.4, -1.7, 1.2, T, true, 33.0, 8, "storage", "TK-101 low" },
    { "TE-172", "TK-101", "shell", -2.4, -1.7, 3.6, T, false, 34.5, 8, "storage", "TK-101 middle" },
    { "TE-173", "TK-101", "shell", -2.4, -1.7, 6.2, T, false, 36.0, 8, "storage", "TK-101 high" },
    { "TE-174", "TK-101", "shell", -1.0, -0.8, 8.0, T, false, 41.0, 15, "weather", "TK-101 roof" },
    { "PT-171", "TK-101", "shell", -2.9, -0.4, 1.0, P, false, 0.5, 0, "storage", "TK-101 head" },
    { "TE-176", "TK-102", "shell", -1.9, -1.3, 1.2, T, true, 30.5, 8, "storage", "TK-102 low" },
    { "TE-177", "TK-102", "shell", -1.9, -1.3, 3.0, T, false, 31.0, 8, "storage", "TK-102 middle" },
    { "TE-178", "TK-102", "shell", -1.9, -1.3, 5.0, T, false, 32.0, 8, "storage", "TK-102 high" },
    { "PT-176", "TK-102", "shell", -2.3, -0.3, 1.0, P, false, 0.4, 0, "storage", "TK-102 head" },
    /* Pipes: skin temperatures, in the plant frame. */
    { "TE-301", "L-101", "pipe", 8.6, -6.2, 1.0, T, false, 33.5, 8, "charge", "Feed from TK-101" },
    { "TE-302", "L-101", "pipe", -3.5, -11.3, 0.7, T, false, 35.0, 8, "charge", "Feed to E-101, east" },
    { "TE-303", "L-101", "pipe", -12.0, -11.3, 0.7, T, false, 35.0, 8, "charge", "Feed to E-101, west" },
    { "TE-304", "L-101", "cladding", -16.0, -1.5, 3.5, T, true, 100.0, 10, "preheat", "Warm feed from E-101" },
    { "TE-305", "L-101", "cladding", -11.5, 7.7, 4.7, T, false, 99.0, 10, "preheat", "Warm feed on the rack" },
    { "TE-306", "L-101", "cladding", -6.9, 4.4, 8.0, T, false, 98.0, 10, "preheat", "Warm feed to T-101" },
    { "TE-307", "L-101", "pipe", 5.6, -9.6, 2.7, T, false, 34.5, 8, "charge", "Feed pump discharge" },
    { "TE-311", "L-102", "cladding", -8.2, 5.6, 17.0, T, false, 71.0, 15, "column", "Overhead vapour, down the column" },
    { "TE-312", "L-102", "cladding", -2.0, 5.35, 12.3, T, true, 70.0, 15, "column", "Overhead vapour, west" },
    { "TE-313", "L-102", "cladding", 6.0, 5.35, 12.3, T, false, 69.5, 15, "column", "Overhead vapour, east" },
    { "TE-314", "L-102", "pipe", 4.2, 8.0, 9.6, T, false, 51.5, 8, "fans", "From EA-101 to E-103" },
    { "TE-315", "L-102", "pipe", -0.97, 3.3, 6.9, T, false, 40.0, 6, "condenser", "From E-103 to V-101" },
    { "TE-321", "L-103", "pipe", 2.23, -0.5, 1.0, T, false, 39.0, 15, "reflux", "Reflux pump suction" },
    { "TE-322", "L-103", "pipe", -4.9, 0.8, 3.6, T, true, 39.5, 15, "reflux", "Reflux, from the pumps" },
    { "TE-323", "L-103", "pipe", -7.5, 4.9, 9.0, T, false, 39.5, 15, "reflux", "Reflux, up the column" },
    { "TE-324", "L-103", "pipe", -7.5, 4.9, 16.0, T, false, 39.5, 15, "reflux", "Reflux, near the top" },
    { "TE-325", "L-103", "pipe", 0.0, -10.9, 0.5, T, false, 31.5, 15, "distillate", "Distillate to TK-102" },
    { "TE-326", "L-103", "pipe", -5.6, -5.1, 3.6, T, false, 39.5, 15, "reflux", "Distillate to E-105" },
    { "TE-327", "L-103", "pipe", 6.6, -8.6, 0.4, T, false, 31.5, 15, "distillate", "Distillate at TK-102" },
    { "TE-331", "L-104", "cladding", -11.6, 5.2, 0.6, T, false, 165.0, 8, "reboiler", "From T-101 to E-102" },
    { "TE-332", "L-104", "cladding", -12.0, 3.6, 4.9, T, true, 168.0, 8, "reboiler", "Reboiler vapour" },
    { "TE-333", "L-104", "cladding", -12.6, 0.0, 0.7, T, false, 164.0, 8, "reboiler", "Bottoms pump suction" },
    { "TE-334", "L-104", "cladding", -10.5, -4.1, 3.1, T, true, 162.0, 10, "reboiler", "Bottoms to E-101" },
    { "TE-335", "L-104", "cladding", -13.7, -6.5, 2.6, T, false, 95.0, 10, "bottoms", "From E-101 to E-104" },
    { "TE-336", "L-104", "pipe", -11.0, 2.0, 1.4, T, false, 45.0, 14, "product", "Bottoms product, cooled" },
    { "TE-337", "L-104", "pipe", -15.5, 8.2, 4.6, T, false, 44.5, 14, "product", "Bottoms product to battery limit" },
    { "TE-338", "L-104", "pipe", -10.1, -7.2, 0.5, T, false, 46.0, 14, "product", "Bottoms product behind E-104" },
    { "TE-341", "L-105", "pipe", 4.5, 3.4, 6.7, T, false, 38.5, 15, "offgas", "Off-gas from V-101" },
    { "TE-342", "L-105", "pipe", 11.0, 3.6, 5.8, T, false, 37.5, 15, "offgas", "K-101 suction" },
    { "TE-343", "L-105", "cladding", 13.5, 6.0, 4.2, T, true, 98.0, 15, "offgas", "K-101 discharge" },
    { "TE-344", "L-105", "cladding", 16.5, 8.0, 6.6, T, false, 96.0, 15, "offgas", "Compressed gas to battery limit" },
    { "TE-351", "L-106", "water pipe", -12.0, 9.2, 4.8, T, true, 25.0, 10, "water", "Cooling water supply, west" },
    { "TE-352", "L-106", "water pipe", 7.0, 9.2, 4.8, T, false, 25.5, 10, "water", "Cooling water supply, east" },
    { "TE-353", "L-106", "water pipe", -12.0, 9.9, 4.8, T, true, 36.0, 15, "cooling", "Cooling water return, west" },
    { "TE-354", "L-106", "water pipe", 7.0, 9.9, 4.8, T, false, 36.5, 15, "cooling", "Cooling water return, east" },
    { "TE-355", "L-106", "water pipe", -10.85, -9.0, 1.6, T, false, 36.0, 15, "cooling", "Return from E-104" },
    { "TE-356", "L-106", "water pipe", -7.85, -9.0, 1.6, T, false, 33.0, 15, "cooling", "Return from E-105" },
    { "TE-357", "L-106", "water pipe", -11.6, -10.2, 0.5, T, false, 25.5, 10, "water", "Supply to E-104" },
    { "TE-358", "L-106", "water pipe", -8.6, -10.2, 0.5, T, false, 25.5, 10, "water", "Supply to E-105" },
    { "TE-361", "L-107", "cladding", -14.5, 8.0, 6.7, T, true, 179.0, 6, "steam", "Steam header, west" },
    { "TE-362", "L-107", "cladding", 2.0, 8.0, 6.7, T, false, 177.0, 6, "steam", "Steam header, east" },
    { "TE-363", "L-107", "cladding", -17.6, 3.6, 5.8, T, false, 178.0, 6, "steam", "Steam to E-102" },
    { "TE-364", "L-107", "cladding", -18.7, 6.5, 0.6, T, false, 142.0, 10, "steam", "Condensate from E-102" },
};

/* Every pump carries the same instruments; the number after the letters is the pump's base number plus the row's. */
struct pump {
    const char *name;
    int base;
    const char *liquid_loop, *machine_loop;
    double liquid, bearing, winding, suction_bar, discharge_bar, vibration; /* degC, bar, mm/s */
};
static const struct pump pumps[] = {
    { "P-101A", 210, "charge", "P-101", 34.0, 52.0, 78.0, 1.2, 12.4, 2.2 },
    { "P-101B", 220, "charge", "spare", 33.0, 27.0, 26.0, 1.2, 1.2, 0.3 },
    { "P-102A", 230, "reflux", "P-102", 39.0, 55.0, 81.0, 6.3, 11.9, 2.7 },
    { "P-102B", 240, "reflux", "spare", 38.0, 28.0, 26.0, 6.3, 6.3, 0.4 },
    { "P-103A", 250, "reboiler", "P-103", 163.0, 74.0, 84.0, 7.6, 12.8, 3.0 },
    { "P-103B", 260, "reboiler", "spare", 118.0, 41.0, 28.0, 7.6, 7.6, 0.4 },
};

static void add(struct tags *tags, const struct row *row, char *owned_name, char *owned_description)
{
    mem_grow(&tags->at, &tags->capacity, tags->count + 1, sizeof(*tags->at));
    tags->at[tags->count++] = (struct tag){ .name = owned_name,
                                            .description = owned_description,
                                            .asset = row->asset,
                                            .part = row->part,
                                            .near = vec(row->x, row->y, row->z),
                                            .kind = row->kind,
                                            .node = row->node,
                                            .value = row->value,
                                            .band = row->band,
                                            .loop = row->loop };
}

static void add_pump(struct tags *tags, const struct pump *pump)
{
    const char *name = pump->name, *discharge = pump->base == 210 ? "feed" : pump->liquid_loop;
    const double surge_bar = pump->discharge_bar > pump->suction_bar ? 1.5 : 0.0, v = pump->vibration;
    const struct row instruments[] = {
        { "TE-", name, "casing", -0.25, -0.25, 0.95, T, true, pump->liquid, 15, pump->liquid_loop, "casing" },
        { "TE-", name, "bearing housing", 0.19, -0.05, 0.95, T, false, pump->bearing, 14, pump->machine_loop, "bearing" },
        { "TE-", name, "motor", 1.0, -0.2, 0.9, TAG_WINDING, false, pump->winding, 20, pump->machine_loop, "motor winding" },
        { "PT-", name, "casing", -0.60, -0.05, 0.93, P, false, pump->suction_bar, 0, pump->liquid_loop, "suction" },
        { "PT-", name, "casing", -0.32, -0.09, 1.10, P, true, pump->discharge_bar, surge_bar, discharge, "discharge" },
        { "VT-", name, "bearing housing", -0.08, 0.0, 0.97, V, true, v, 0, pump->machine_loop, "pump, casing end" },
        { "VT-", name, "bearing housing", 0.19, 0.05, 0.97, V, false, v * 1.12, 0, pump->machine_loop, "pump, coupling end" },
        { "VT-", name, "motor", 0.64, 0.0, 1.07, V, true, v * 0.8, 0, pump->machine_loop, "motor, coupling end" },
        { "VT-", name, "motor", 1.30, 0.0, 1.07, V, false, v * 0.65, 0, pump->machine_loop, "motor, fan end" },
    };
    for (int i = 0; i < (int)(sizeof(instruments) / sizeof(instruments[0])); i++) {
        const struct row *row = instruments + i;
        add(tags, row, mem_printf("%s%d", row->name, pump->base + i + 1), mem_printf("%s %s", name, row->description));
    }
}

static void give_addresses(struct tags *tags)
{
    int next[] = { [TAG_TEMPERATURE] = 40001, [TAG_PRESSURE] = 40401, [TAG_VIBRATION] = 40601 };
    for (size_t i = 0; i < tags->count; i++) {
        struct tag *tag = tags->at + i;
        int *address = next + (tag->kind == TAG_WINDING ? TAG_TEMPERATURE : tag->kind);
        tag->address = *address;
        *address += tag->kind == TAG_TEMPERATURE || tag->kind == TAG_VIBRATION ? 2 : 1;
    }
}

void tags_make(struct tags *tags)
{
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++)
        add(tags, rows + i, mem_strdup(rows[i].name), mem_strdup(rows[i].description));
    for (size_t i = 0; i < sizeof(pumps) / sizeof(pumps[0]); i++)
        add_pump(tags, pumps + i);
    give_addresses(tags);
}

void tags_finish(struct tags *tags)
{
    for (size_t i = 0; i < tags->count; i++) {
        mem_free(tags->at[i].name);
        mem_free(tags->at[i].description);
    }
    mem_free(tags->at);
    *tags = (struct tags){ 0 };
}
