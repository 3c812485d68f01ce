_g4lidar.(POINT|POSE)_DTYPE$:
    \1_DTYPE: numpy.dtype[numpy.void]

_g4lidar._problems$:
    _problems: dict[str, str]
