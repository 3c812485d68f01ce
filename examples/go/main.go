// SPDX-License-Identifier: MIT

// Reads five revolutions of a G4 in Go, by cgo: go run . [DEVICE]. CGO_CFLAGS and CGO_LDFLAGS name the
// directories of libg4lidar_c, if it is not installed.
package main

// #cgo LDFLAGS: -lg4lidar_c
// #include <g4lidar.h>
// #include <stdlib.h>
import "C"

import (
	"errors"
	"fmt"
	"math"
	"os"
	"unsafe"
)

func checked(code C.int, why *C.g4lidar_error) error {
	if code == C.G4LIDAR_OK {
		return nil
	}
	return errors.New(C.GoString(&why.message[0]) + " " + C.GoString(&why.advice[0]))
}

func run(device string) error {
	name := C.CString(device)
	defer C.free(unsafe.Pointer(name))
	var why C.g4lidar_error
	var lidar *C.g4lidar_lidar
	if err := checked(C.g4lidar_open(name, &lidar, &why), &why); err != nil {
		return err
	}
	defer C.g4lidar_free(lidar) // stops the motor
	if err := checked(C.g4lidar_start(lidar, &why), &why); err != nil {
		return err
	}
	for i := 0; i < 5; i++ {
		var scan *C.g4lidar_scan
		if err := checked(C.g4lidar_wait_scan(lidar, 5000, &scan, &why), &why); err != nil {
			return err
		}
		points := unsafe.Slice(scan.points, int(scan.point_count)) // valid until the next call
		nearest := math.Inf(1)
		for _, each := range points {
			if each.flags&C.G4LIDAR_NO_RETURN == 0 { // no return is not free space: see near_options of g4lidar_shaper_options
				nearest = math.Min(nearest, float64(each.range_mm)/1000)
			}
		}
		fmt.Printf("%d points at %.2f Hz, the nearest %.3f m away\n", len(points), float64(scan.frequency_hz), nearest)
	}
	return nil
}

func main() {
	device := ""
	if len(os.Args) > 1 {
		device = os.Args[1]
	}
	if err := run(device); err != nil {
		fmt.Fprintln(os.Stderr, err)
		os.Exit(1)
	}
}
