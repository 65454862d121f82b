/// The kernel's clock and alarm on what QEMU's STM32F2 and F4 machines have: TIM2 counts microseconds and
/// loses none when the host is slow; SysTick is the alarm. (QEMU's timers have no compare interrupt, so the
/// HAL's driver, which is for real chips, would never wake up here.) [ChibiOS chcore.h, PORT_USE_ALT_TIMER]
#ifndef CHCORE_TIMER_ALT_H
#define CHCORE_TIMER_ALT_H

#define OCM_TIM2_CNT (*(volatile uint32_t*)0x40000024U) /* [RM0090, 18.4.21] */

#ifdef __cplusplus
extern "C" {
#endif
void ocm_alarm_start(systime_t time);
void ocm_alarm_stop(void);
systime_t ocm_alarm_get(void);
#ifdef __cplusplus
}
#endif

static inline void port_timer_start_alarm(systime_t time) { ocm_alarm_start(time); }
static inline void port_timer_stop_alarm(void) { ocm_alarm_stop(); }
static inline void port_timer_set_alarm(systime_t time) { ocm_alarm_start(time); }
static inline systime_t port_timer_get_time(void) { return (systime_t)OCM_TIM2_CNT; }
static inline systime_t port_timer_get_alarm(void) { return ocm_alarm_get(); }

#endif
