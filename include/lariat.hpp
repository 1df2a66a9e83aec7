#pragma once
#include <lariat.h>
