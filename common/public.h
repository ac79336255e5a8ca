// What liblimber.so shows to programs of others; everything else is hidden in it.
#pragma once

#define LIMBER_PUBLIC __attribute__((visibility("default")))
