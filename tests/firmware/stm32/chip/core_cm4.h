#pragma once
#include "core_cm3.h"
