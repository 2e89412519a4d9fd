#include "../tbb_stand_in.h"
