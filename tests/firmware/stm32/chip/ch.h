/* ChibiOS's kernel, as far as one thread can tell. */
#pragma once

#include <stddef.h>
#include <stdint.h>

typedef uint32_t systime_t;
typedef uint32_t syssts_t;
typedef uint32_t tprio_t;
typedef int32_t msg_t;
typedef void* thread_reference_t;
typedef struct {
  int nothing;
} virtual_timer_t;
typedef struct {
  int nothing;
} thread_t;
typedef struct {
  int locked;
} mutex_t;

#define MSG_OK 0
#define MSG_TIMEOUT (-1)
#define MSG_RESET (-2)
#define CH_CFG_ST_FREQUENCY 1000000
#define NORMALPRIO 128
#define MS2ST(ms) (1000U * (ms))
#define THD_WORKING_AREA(name, size) uint8_t name[size]

inline syssts_t chSysGetStatusAndLockX(void) {
  return 0;
}
inline void chSysRestoreStatusX(syssts_t) {}
inline void chMtxObjectInit(mutex_t* mutex) {
  mutex->locked = 0;
}
inline void chMtxLock(mutex_t* mutex) {
  ++mutex->locked;
}
inline bool chMtxTryLock(mutex_t* mutex) {
  return mutex->locked++ == 0;
}
inline void chMtxUnlock(mutex_t* mutex) {
  --mutex->locked;
}
inline void chThdResumeI(thread_reference_t*, msg_t) {}
inline msg_t chThdSuspendS(thread_reference_t*) {
  return MSG_OK;
}
inline thread_t* chThdCreateStatic(void*, size_t, tprio_t, void (*)(void*), void*) {
  return nullptr;
}
inline tprio_t chThdSetPriority(tprio_t priority) {
  return priority;
}
void chSysInit(void);
void chThdSleepMicroseconds(uint32_t us);
