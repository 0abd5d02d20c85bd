// SPDX-License-Identifier: BSD-3-Clause
// OpenNI2's driver interface; its package lacks the header that defines these two.
#pragma once

#define XN_NEW(type, arg) new type(arg)
#define XN_DELETE(pointer) delete (pointer)
#include <Driver/OniDriverAPI.h>
