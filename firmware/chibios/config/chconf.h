/// What our images use of the ChibiOS kernel, RT 4. For the C compiler, the assembler and C++. The names
/// are the kernel's own, explained in its os/rt/templates; given here is why we choose as we do.
///
/// OCM_SYSTEM_TIME_BITS: width of the chip's free-running timer, 16 (STM32F103) or 32;
/// firmware/CMakeLists.txt. OCM_KERNEL_CHECKS: TRUE where a halt tells us something (QEMU), FALSE on a
/// robot.
#ifndef CHCONF_H
#define CHCONF_H

#define _CHIBIOS_RT_CONF_

/* Time: a free-running timer at 1 MHz and no tick. All periods on the wire are whole microseconds, and the
   board sleeps until the next release. 10 us is the nearest alarm: longer than the way from reading the
   counter to arming the compare register, which must not be overtaken (a missed compare costs a whole turn
   of the counter). */
#define CH_CFG_ST_RESOLUTION                OCM_SYSTEM_TIME_BITS
#define CH_CFG_ST_FREQUENCY                 1000000
#define CH_CFG_ST_TIMEDELTA                 10
#define CH_CFG_TIME_QUANTUM                 0   /* one thread a level: none to take turns with */

#define CH_CFG_MEMCORE_SIZE                 0
#define CH_CFG_NO_IDLE_THREAD               FALSE
#define CH_CFG_OPTIMIZE_SPEED               FALSE

/* Threads, mutexes with priority inheritance and, for the HAL, semaphores. Nothing is created while
   running. */
#define CH_CFG_USE_TM                       FALSE
#define CH_CFG_USE_REGISTRY                 FALSE
#define CH_CFG_USE_WAITEXIT                 FALSE
#define CH_CFG_USE_SEMAPHORES               TRUE
#define CH_CFG_USE_SEMAPHORES_PRIORITY      FALSE
#define CH_CFG_USE_MUTEXES                  TRUE
#define CH_CFG_USE_MUTEXES_RECURSIVE        FALSE
#define CH_CFG_USE_CONDVARS                 FALSE
#define CH_CFG_USE_CONDVARS_TIMEOUT         FALSE
#define CH_CFG_USE_EVENTS                   FALSE
#define CH_CFG_USE_EVENTS_TIMEOUT           FALSE
#define CH_CFG_USE_MESSAGES                 FALSE
#define CH_CFG_USE_MESSAGES_PRIORITY        FALSE
#define CH_CFG_USE_MAILBOXES                FALSE
#define CH_CFG_USE_MEMCORE                  FALSE
#define CH_CFG_USE_HEAP                     FALSE
#define CH_CFG_USE_MEMPOOLS                 FALSE
#define CH_CFG_USE_DYNAMIC                  FALSE

/* Assertions stay off in QEMU too: one of them measures the way from reading the clock to arming the
   alarm, and the host may hold up an emulated CPU anywhere. */
#define CH_DBG_STATISTICS                   FALSE
#define CH_DBG_SYSTEM_STATE_CHECK           OCM_KERNEL_CHECKS
#define CH_DBG_ENABLE_CHECKS                OCM_KERNEL_CHECKS
#define CH_DBG_ENABLE_ASSERTS               FALSE
#define CH_DBG_TRACE_MASK                   CH_DBG_TRACE_MASK_NONE
#define CH_DBG_TRACE_BUFFER_SIZE            128
#define CH_DBG_ENABLE_STACK_CHECK           OCM_KERNEL_CHECKS
#define CH_DBG_FILL_THREADS                 TRUE  /* Runtime::unused_stack() counts what is left of it */
#define CH_DBG_THREADS_PROFILING            FALSE

#define CH_CFG_THREAD_EXTRA_FIELDS
#define CH_CFG_THREAD_INIT_HOOK(tp) {}
#define CH_CFG_THREAD_EXIT_HOOK(tp) {}
#define CH_CFG_CONTEXT_SWITCH_HOOK(ntp, otp) {}
#define CH_CFG_IRQ_PROLOGUE_HOOK() {}
#define CH_CFG_IRQ_EPILOGUE_HOOK() {}
#define CH_CFG_IDLE_ENTER_HOOK() { ocm_idle_enter(); }
#define CH_CFG_IDLE_LEAVE_HOOK() { ocm_idle_leave(); }
#define CH_CFG_IDLE_LOOP_HOOK() {}
#define CH_CFG_SYSTEM_TICK_HOOK() {}
#define CH_CFG_SYSTEM_HALT_HOOK(reason) { ocm_halted(reason); }
#define CH_CFG_TRACE_HOOK(tep) {}

/* Sleep when nothing is to be done: saves the battery, and the host's CPU under QEMU. */
#if !defined(CORTEX_ENABLE_WFI_IDLE)
#define CORTEX_ENABLE_WFI_IDLE              TRUE
#endif

#if !defined(_FROM_ASM_)
#ifdef __cplusplus
extern "C" {
#endif
void ocm_idle_enter(void);              /* both: firmware/chibios/port.hpp, kernel locked */
void ocm_idle_leave(void);
void ocm_halted(const char* reason);    /* the image says what a dead kernel does: interrupts are off */
#ifdef __cplusplus
}
#endif
#endif

#endif
