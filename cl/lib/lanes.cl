// Integer code that is written once for one path and for sixteen at once, a lane a path: LANES is the type of a number. Where sixteen are wanted too,
// the host includes such a file a second time, with uint16 and with names that end in _lanes (lumiere/device/source.py).

#define LANES uint
