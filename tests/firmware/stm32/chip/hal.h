/* ChibiOS's hardware layer: what it does to registers is done, its drivers are played by fixture.cpp. */
#pragma once

#include "ch.h"
#if defined(STM32F103xE)
#include <stm32f103xe.h>
#define STM32_PCLK1 36000000U
#else
#include <stm32f405xx.h>
#define STM32_PCLK1 42000000U
#endif
#undef DBGMCU
extern DBGMCU_TypeDef played_dbgmcu;
#define DBGMCU (&played_dbgmcu)

#define STM32_USART1_NUMBER 37 /* [RM0008 table 63, RM0090 table 62] */
#define STM32_USART1_HANDLER VectorD4
#define STM32_CAN1_TX_NUMBER 19
#define STM32_CAN1_TX_HANDLER Vector8C
#define STM32_CAN1_RX0_NUMBER 20
#define STM32_CAN1_RX0_HANDLER Vector90
#define STM32_CAN1_SCE_NUMBER 22
#define STM32_CAN1_SCE_HANDLER Vector98
#define OSAL_IRQ_HANDLER(name) void name(void)
#define PORT_FAST_IRQ_HANDLER(name) void name(void)
#define OSAL_IRQ_PROLOGUE()
#define OSAL_IRQ_EPILOGUE()

void nvicEnableVector(uint32_t number, uint32_t priority);

#define rccEnableAPB1(mask, low_power) (RCC->APB1ENR |= (mask))
#define rccEnableAPB2(mask, low_power) (RCC->APB2ENR |= (mask))
#define rccEnableTIM2(low_power) rccEnableAPB1(RCC_APB1ENR_TIM2EN, low_power)
#define rccEnableTIM3(low_power) rccEnableAPB1(RCC_APB1ENR_TIM3EN, low_power)
#define rccEnableTIM4(low_power) rccEnableAPB1(RCC_APB1ENR_TIM4EN, low_power)
#define rccEnableCAN1(low_power) rccEnableAPB1(RCC_APB1ENR_CAN1EN, low_power)
void rccResetCAN1(void);
#define rccEnableUSART1(low_power) rccEnableAPB2(RCC_APB2ENR_USART1EN, low_power)
#define rccEnablePWRInterface(low_power) rccEnableAPB1(RCC_APB1ENR_PWREN, low_power)

typedef GPIO_TypeDef* ioportid_t;
typedef uint32_t iomode_t;
#define PAL_MODE_OUTPUT_OPENDRAIN 7U
#if defined(STM32F103xE)
typedef struct {
  uint32_t odr, crl, crh;
} stm32_gpio_setup_t;
typedef struct {
  stm32_gpio_setup_t PAData, PBData, PCData, PDData, PEData, PFData, PGData;
} PALConfig;
#else
typedef struct {
  uint32_t moder, otyper, ospeedr, pupdr, odr, afrl, afrh;
} stm32_gpio_setup_t;
typedef struct {
  stm32_gpio_setup_t PAData, PBData, PCData, PDData, PEData, PFData, PGData, PHData, PIData;
} PALConfig;
#endif
void palInit(const PALConfig* config);
void palWritePad(ioportid_t port, uint8_t pad, uint8_t level);
uint8_t palReadPad(ioportid_t port, uint8_t pad);
void palSetPadMode(ioportid_t port, uint8_t pad, iomode_t mode);
#define palSetPad(port, pad) palWritePad(port, pad, 1)
#define palClearPad(port, pad) palWritePad(port, pad, 0)

void dmaInit(void);
void i2cInit(void);
void spiInit(void);
void stInit(void);
extern "C" void stm32_clock_init(void);

typedef uint32_t i2cflags_t;
#define I2C_ACK_FAILURE 0x04U
#define I2C_ARBITRATION_LOST 0x02U
typedef enum { OPMODE_I2C = 1 } i2copmode_t;
typedef enum { STD_DUTY_CYCLE = 1, FAST_DUTY_CYCLE_2 = 2 } i2cdutycycle_t;
typedef struct {
  i2copmode_t op_mode;
  uint32_t clock_speed;
  i2cdutycycle_t duty_cycle;
} I2CConfig;
typedef struct {
  const I2CConfig* config; /* nullptr: stopped */
} I2CDriver;
void i2cStart(I2CDriver* driver, const I2CConfig* config);
void i2cStop(I2CDriver* driver);
i2cflags_t i2cGetErrors(I2CDriver* driver);
msg_t i2cMasterTransmitTimeout(I2CDriver* driver, uint8_t address, const uint8_t* out, size_t out_size,
                               uint8_t* in, size_t in_size, systime_t timeout);
msg_t i2cMasterReceiveTimeout(I2CDriver* driver, uint8_t address, uint8_t* in, size_t in_size,
                              systime_t timeout);

typedef struct {
  void (*end)(void);
  ioportid_t port;
  uint8_t pad;
  uint16_t cr1;
} SPIConfig;
typedef struct {
  const SPIConfig* config;
  SPIConfig last; /* of the exchange before, when the driver has stopped */
} SPIDriver;
void spiStart(SPIDriver* driver, const SPIConfig* config);
void spiStop(SPIDriver* driver);
void spiSelect(SPIDriver* driver);
void spiUnselect(SPIDriver* driver);
void spiExchange(SPIDriver* driver, size_t size, const void* out, void* in);
