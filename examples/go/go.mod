module g4lidar-example

go 1.19
