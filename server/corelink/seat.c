/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the file FOLDER/node, which holds a random number, the file's inode, and the machine's id. */
#include "corelink/seat.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdint.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { LINE_BYTES = 128, MACHINE_BYTES = 64 };

static void read_machine(char out[MACHINE_BYTES])
{
    size_t count;
    char *text = text_read_file("/etc/machine-id", MACHINE_BYTES - 1, &count);
    size_t length = text ? strcspn(text, " \t\r\n") : 0;
    snprintf(out, MACHINE_BYTES, "%.*s", length ? (int)length : 1, length ? text : "-");
    mem_free(text);
}

/* Reads the random number. Returns false if the folder was copied: the inode, or the machine's id, then differs from the one in the
   file. */
static bool read_id(struct seat *seat, unsigned long long inode, const char *machine)
{
    char line[LINE_BYTES] = "", of[MACHINE_BYTES] = "";
    unsigned long long told;
    return pread(seat->fd, line, sizeof(line) - 1, 0) > 0 && sscanf(line, "%8[0-9a-f] %llu %63s", seat->id, &told, of) == 3 &&
           strlen(seat->id) == 8 && told == inode && !strcmp(of, machine);
}

static bool write_id(struct seat *seat, unsigned long long inode, const char *machine)
{
    char line[LINE_BYTES];
    uint32_t number;
    if (getrandom(&number, sizeof(number), 0) != sizeof(number))
        return false;
    snprintf(seat->id, sizeof(seat->id), "%08x", number);
    int count = snprintf(line, sizeof(line), "%s %llu %s\n", seat->id, inode, machine);
    return ftruncate(seat->fd, 0) == 0 && pwrite(seat->fd, line, (size_t)count, 0) == count && fsync(seat->fd) == 0;
}

char *seat_take(struct seat *seat, const char *folder)
{
    char *path = mem_printf("%s/node", folder), *why = NULL, machine[MACHINE_BYTES];
    struct stat st;
    mkdir(folder, 0777);
    read_machine(machine);
    *seat = (struct seat){ .fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600) };
    if (seat->fd >= 0 && flock(seat->fd, LOCK_EX | LOCK_NB) != 0)
        why = errno == EWOULDBLOCK
                  ? mem_printf("%s: another core on this machine uses this history: give each core its own --history", folder)
                  : mem_printf("%s: cannot be locked: %s", path, strerror(errno));
    else if (seat->fd < 0 || fstat(seat->fd, &st) != 0 ||
             (!read_id(seat, st.st_ino, machine) && !write_id(seat, st.st_ino, machine)))
        why = mem_printf("%s: %s", path, strerror(errno));
    if (why)
        seat_leave(seat);
    mem_free(path);
    return why;
}

void seat_leave(struct seat *seat)
{
    if (seat->fd > 0)
        close(seat->fd);
    seat->fd = 0;
}
