/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An allow-list of system calls in classic BPF. The list's length costs nothing, because the kernel caches the verdict for
   calls that do not depend on arguments. */
#include "base/system/confine_calls.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/sched.h>
#include <linux/seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define OWN_ARCH AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OWN_ARCH AUDIT_ARCH_AARCH64
#endif

#ifdef OWN_ARCH
/* FIRST_NEWER_CALL: number of cachestat (Linux 6.5), the first system call newer than the list. It and all higher numbers,
   including those of the x32 ABI, count as unknown */
enum { MAX_INSTRUCTIONS = 1024, FIRST_NEWER_CALL = 451 };
#define NAMESPACES (CLONE_NEWNS | CLONE_NEWCGROUP | CLONE_NEWUTS | CLONE_NEWIPC | CLONE_NEWUSER | CLONE_NEWPID | CLONE_NEWNET)
#ifndef PR_SET_VMA
#define PR_SET_VMA 0x53564d41
#endif
#ifndef SYS_landlock_create_ruleset
#define SYS_landlock_create_ruleset 444
#define SYS_landlock_add_rule 445
#define SYS_landlock_restrict_self 446
#endif

struct filter_program {
    struct sock_filter at[MAX_INSTRUCTIONS];
    unsigned short count;
};

struct values {
    uint32_t at[12];
    int count;
};

/* Calls that parsing needs: memory, threads, time, signals to the process itself, and files. Landlock decides which files. */
static const int reader_calls[] = {
    SYS_brk, SYS_mmap, SYS_munmap, SYS_mprotect, SYS_mremap, SYS_madvise, SYS_msync, SYS_mincore, SYS_mlock, SYS_munlock, SYS_membarrier,
    SYS_exit, SYS_exit_group, SYS_futex, SYS_set_robust_list, SYS_set_tid_address, SYS_rseq, SYS_getpid, SYS_getppid, SYS_gettid,
    SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid, SYS_getresuid, SYS_getresgid, SYS_getgroups, SYS_getpgid, SYS_getsid, SYS_getrusage,
    SYS_times, SYS_sched_yield, SYS_sched_getaffinity, SYS_sched_getparam, SYS_sched_getscheduler, SYS_sched_get_priority_max,
    SYS_sched_get_priority_min, SYS_sysinfo, SYS_uname, SYS_getcpu, SYS_getpriority, SYS_capget, SYS_execve, SYS_wait4, SYS_waitid,
    SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_rt_sigpending, SYS_rt_sigtimedwait, SYS_rt_sigsuspend, SYS_sigaltstack,
    SYS_restart_syscall, SYS_clock_gettime, SYS_clock_getres, SYS_clock_nanosleep, SYS_nanosleep, SYS_gettimeofday, SYS_timer_create,
    SYS_timer_settime, SYS_timer_gettime, SYS_timer_delete, SYS_setitimer, SYS_getitimer, SYS_timerfd_create, SYS_timerfd_settime,
    SYS_timerfd_gettime, SYS_getrandom, SYS_read, SYS_write, SYS_readv, SYS_writev, SYS_pread64, SYS_pwrite64, SYS_preadv, SYS_pwritev,
    SYS_preadv2, SYS_pwritev2, SYS_openat, SYS_close, SYS_close_range, SYS_dup, SYS_dup3, SYS_lseek, SYS_fstat,
    SYS_newfstatat, SYS_statx, SYS_statfs, SYS_fstatfs, SYS_faccessat, SYS_faccessat2, SYS_readlinkat, SYS_getcwd, SYS_chdir, SYS_fchdir,
    SYS_getdents64, SYS_renameat, SYS_renameat2, SYS_unlinkat, SYS_mkdirat, SYS_ftruncate, SYS_fallocate, SYS_fsync, SYS_fdatasync,
    SYS_flock, SYS_fadvise64, SYS_umask, SYS_copy_file_range, SYS_sendfile, SYS_pipe2, SYS_ppoll, SYS_pselect6, SYS_epoll_create1,
    SYS_epoll_ctl, SYS_epoll_pwait, SYS_eventfd2, SYS_signalfd4, SYS_socketpair, SYS_shutdown, SYS_getsockopt, SYS_getsockname,
#ifdef __x86_64__
    SYS_arch_prctl, SYS_getpgrp, SYS_getrlimit, SYS_time, SYS_alarm, SYS_pause, SYS_open, SYS_creat, SYS_dup2, SYS_stat, SYS_lstat,
    SYS_access, SYS_readlink, SYS_getdents, SYS_rename, SYS_unlink, SYS_mkdir, SYS_rmdir, SYS_pipe, SYS_poll, SYS_select,
    SYS_epoll_create, SYS_epoll_wait, SYS_eventfd, SYS_signalfd,
#endif
};

/* Additional system calls for the site's commands (its own programs, named in the plant file): they may start programs, and
   change files in the folder that they may write. */
static const int command_calls[] = {
    SYS_kill, SYS_tgkill, SYS_pidfd_open, SYS_pidfd_send_signal, SYS_setpgid, SYS_prctl, SYS_seccomp, SYS_capset, SYS_fchmod, SYS_fchown,
    SYS_landlock_create_ruleset, SYS_landlock_add_rule, SYS_landlock_restrict_self, SYS_sched_setaffinity,
    SYS_fchmodat, SYS_fchownat, SYS_linkat, SYS_symlinkat, SYS_mknodat, SYS_utimensat, SYS_truncate, SYS_memfd_create, SYS_setsid,
    SYS_sendto, SYS_recvfrom, SYS_sendmsg, SYS_recvmsg, SYS_setsockopt, SYS_splice, SYS_tee, SYS_personality, SYS_setpriority,
    SYS_sched_setscheduler, SYS_sched_setparam, SYS_sched_getattr, SYS_sched_setattr, SYS_inotify_init1, SYS_inotify_add_watch,
    SYS_inotify_rm_watch, SYS_shmget, SYS_shmat, SYS_shmdt, SYS_shmctl, SYS_semget, SYS_semop, SYS_semctl, SYS_mlockall, SYS_munlockall,
    SYS_getxattr, SYS_lgetxattr, SYS_fgetxattr, SYS_listxattr, SYS_readahead, SYS_sync, SYS_sync_file_range, SYS_setrlimit,
#ifdef __x86_64__
    SYS_fork, SYS_vfork, SYS_chmod, SYS_chown, SYS_lchown, SYS_link, SYS_symlink, SYS_mknod, SYS_utime, SYS_utimes, SYS_futimesat,
    SYS_inotify_init,
#endif
};

static void add_instruction(struct filter_program *program, unsigned code, uint32_t value, unsigned if_true, unsigned if_false)
{
    program->at[program->count++] = (struct sock_filter){ (uint16_t)code, (uint8_t)if_true, (uint8_t)if_false, value };
}

static void answer(struct filter_program *program, uint32_t value)
{
    add_instruction(program, BPF_RET | BPF_K, value, 0, 0);
}

static void refuse(struct filter_program *program)
{
    answer(program, SECCOMP_RET_ERRNO | EPERM);
}

static void allow(struct filter_program *program, const int *calls, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        add_instruction(program, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)calls[i], 0, 1);
        answer(program, SECCOMP_RET_ALLOW);
    }
}

/* Adds rules for one argument of a system call to the filter. `test` is BPF_JEQ (the argument equals a value) or BPF_JSET (it
   has any bit of a value). allowed true: only arguments that match one of `values` are allowed; false: these are refused.
   Compares the lower 32 bits, all that the kernel uses of an int; they come first in memory, because both supported processors
   are little-endian. */
static void decide(struct filter_program *program, int call, int argument, unsigned test, const struct values *values, bool allowed)
{
    add_instruction(program, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)call, 0, (unsigned)(2 + 2 * values->count));
    add_instruction(program, BPF_LD | BPF_W | BPF_ABS, (uint32_t)(offsetof(struct seccomp_data, args) + 8 * (size_t)argument), 0, 0);
    for (int i = 0; i < values->count; i++) {
        add_instruction(program, BPF_JMP | test | BPF_K, values->at[i], 0, 1);
        answer(program, allowed ? SECCOMP_RET_ALLOW : SECCOMP_RET_ERRNO | EPERM);
    }
    answer(program, allowed ? SECCOMP_RET_ERRNO | EPERM : SECCOMP_RET_ALLOW);
}

/* Refuses O_TRUNC for files opened read-only, which Landlock before ABI 3 would allow. */
static void refuse_emptying(struct filter_program *program, int call, int flags_argument)
{
    add_instruction(program, BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)call, 0, 5);
    add_instruction(program, BPF_LD | BPF_W | BPF_ABS, (uint32_t)(offsetof(struct seccomp_data, args) + 8 * (size_t)flags_argument), 0, 0);
    add_instruction(program, BPF_ALU | BPF_AND | BPF_K, O_TRUNC | O_ACCMODE, 0, 0);
    add_instruction(program, BPF_JMP | BPF_JEQ | BPF_K, O_TRUNC | O_RDONLY, 0, 1);
    refuse(program);
    answer(program, SECCOMP_RET_ALLOW);
}

static void decide_by_arguments(struct filter_program *program, enum confine_role role, bool notifies)
{
    /* allowed ioctl() requests: they can neither inject terminal input (TIOCSTI) nor control devices */
    static const struct values ioctls = { { TCGETS, TIOCGWINSZ, TIOCGPGRP, FIONREAD, FIONBIO, FIOCLEX, FIONCLEX }, 7 };
    /* refused fcntl() commands: they can make the kernel send signals to a descriptor's owner */
    static const struct values owners = { { F_SETOWN, F_SETOWN_EX, F_SETSIG, F_SETLEASE, F_NOTIFY }, 5 };
    static const struct values names = { { PR_SET_NAME, PR_GET_NAME, PR_SET_VMA, PR_GET_DUMPABLE, PR_CAPBSET_READ, PR_GET_TIMERSLACK }, 6 };
    static const struct values itself = { { 0 }, 1 }, unix_sockets = { { AF_UNIX }, 1 }, thread = { { CLONE_THREAD }, 1 };
    static const struct values namespaces = { { (uint32_t)NAMESPACES }, 1 };
    const struct values own = { { (uint32_t)getpid() }, 1 }, self = { { 0, (uint32_t)getpid() }, 2 };
    decide(program, SYS_fcntl, 1, BPF_JEQ, &owners, false);
    /* lets a process change its own limits (pid 0 or its own pid), but not the daemon's */
    decide(program, SYS_prlimit64, 0, BPF_JEQ, role == CONFINE_READER ? &self : &itself, true);
    if (role == CONFINE_READER) {
        decide(program, SYS_kill, 0, BPF_JEQ, &own, true);
        decide(program, SYS_tgkill, 0, BPF_JEQ, &own, true);
        decide(program, SYS_prctl, 0, BPF_JEQ, &names, true);
        decide(program, SYS_sched_setaffinity, 0, BPF_JEQ, &itself, true);
        decide(program, SYS_clone, 0, BPF_JSET, &thread, true);
    } else {
        decide(program, SYS_clone, 0, BPF_JSET, &namespaces, false);
    }
    if (notifies) {
        static const int sends[] = { SYS_sendto };
        decide(program, SYS_socket, 0, BPF_JEQ, &unix_sockets, true);
        allow(program, sends, 1);
    }
    decide(program, SYS_ioctl, 1, BPF_JEQ, &ioctls, true);
}

int confine_calls(enum confine_role role, bool notifies)
{
    struct filter_program program = { .count = 0 };
    add_instruction(&program, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch), 0, 0);
    add_instruction(&program, BPF_JMP | BPF_JEQ | BPF_K, OWN_ARCH, 1, 0);
    answer(&program, SECCOMP_RET_ERRNO | ENOSYS);
    add_instruction(&program, BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr), 0, 0);
    add_instruction(&program, BPF_JMP | BPF_JGE | BPF_K, FIRST_NEWER_CALL, 0, 1);
    answer(&program, SECCOMP_RET_ERRNO | ENOSYS);
    /* refuses clone3() and openat2(): their flags are in memory, which a filter cannot inspect */
    add_instruction(&program, BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 1, 0);
    add_instruction(&program, BPF_JMP | BPF_JEQ | BPF_K, SYS_openat2, 0, 1);
    answer(&program, SECCOMP_RET_ERRNO | ENOSYS);
    refuse_emptying(&program, SYS_openat, 2);
#ifdef __x86_64__
    refuse_emptying(&program, SYS_open, 1);
#endif
    allow(&program, reader_calls, sizeof(reader_calls) / sizeof(reader_calls[0]));
    if (role == CONFINE_COMMAND)
        allow(&program, command_calls, sizeof(command_calls) / sizeof(command_calls[0]));
    decide_by_arguments(&program, role, notifies);
    refuse(&program);
    struct sock_fprog filter = { program.count, program.at };
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0 ? 0 : -errno;
}

#else

int confine_calls(enum confine_role role, bool notifies)
{
    (void)role;
    (void)notifies;
    return -ENOSYS;
}

#endif
