#include "client/trajectory_file.h"
