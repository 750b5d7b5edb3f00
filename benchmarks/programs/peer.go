// Go: goroutines and unbuffered channels, on one processor.
package main

import (
	"fmt"
	"os"
	"reflect"
	"runtime"
	"strconv"
	"strings"
	"time"
)

const batches = 3

func report(nanoseconds float64) { fmt.Printf("%.2f\n", nanoseconds) }

// timed repeats step and reports nanoseconds for each of its divisor parts, once for every batch.
func timed(step func(), count, divisor int) {
	for i := 0; i < count/10; i++ {
		step()
	}
	for batch := 0; batch < batches; batch++ {
		began := time.Now()
		for i := 0; i < count; i++ {
			step()
		}
		report(float64(time.Since(began).Nanoseconds()) / float64(count) / float64(divisor))
	}
}

func copies(source <-chan int, added int, sinks ...chan<- int) {
	for {
		value := <-source
		for _, sink := range sinks {
			sink <- value + added
		}
	}
}

func commstime() {
	a, b, c, d := make(chan int), make(chan int), make(chan int), make(chan int)
	go func() {
		a <- 0
		copies(c, 0, a)
	}()
	go copies(a, 0, b, d)
	go copies(b, 1, c)
	timed(func() { <-d }, 500000, 4)
}

func alternative(size int) {
	cases := make([]reflect.SelectCase, size)
	for i := range cases {
		channel := make(chan int)
		cases[i] = reflect.SelectCase{Dir: reflect.SelectRecv, Chan: reflect.ValueOf(channel)}
		go func() {
			for {
				channel <- 1
			}
		}()
	}
	timed(func() { reflect.Select(cases) }, 2000000/(size+10), 1)
}

func ring(size, rounds int) {
	channels := make([]chan int, size)
	for i := range channels {
		channels[i] = make(chan int)
	}
	for i := 1; i < size; i++ {
		go copies(channels[i-1], 0, channels[i])
	}
	timed(func() { channels[0] <- 1; <-channels[size-1] }, rounds, size)
}

func parallel() {
	timed(func() {
		done := make(chan bool)
		for i := 0; i < 2; i++ {
			go func() { done <- true }()
		}
		<-done
		<-done
	}, 200000, 1)
}

func resident() int {
	text, _ := os.ReadFile("/proc/self/statm")
	pages, _ := strconv.Atoi(strings.Fields(string(text))[1])
	return pages * os.Getpagesize()
}

func memory(size int) {
	runtime.GC()
	before := resident()
	for i := 0; i < size; i++ {
		channel := make(chan int)
		go copies(channel, 0)
	}
	time.Sleep(100 * time.Millisecond)
	runtime.GC()
	report(float64(resident()-before) / float64(size))
}

func main() {
	runtime.GOMAXPROCS(1)
	name := os.Args[1]
	size, _ := strconv.Atoi(name[strings.LastIndex(name, "-")+1:])
	switch {
	case name == "commstime":
		commstime()
	case strings.HasPrefix(name, "alternative-"):
		alternative(size)
	case name == "ring":
		ring(1000, 2000)
	case name == "ring-100000":
		ring(100000, 20)
	case name == "parallel":
		parallel()
	case name == "memory":
		memory(10000)
	}
}
