# SPDX-License-Identifier: MIT
# check_extreme.cmake finds functions that are not called, and wrong lines in left_out.txt.
# cmake -DSCRIPT=<check_extreme.cmake> -DAWK=<awk> -DSCRATCH=<directory> -P check_extreme_test.cmake

cmake_minimum_required(VERSION 3.22)

# expect(<pattern of the output> <test> <left_out.txt>): with one header; an empty pattern: no fault.
function(expect pattern test left_out)
  file(REMOVE_RECURSE "${SCRATCH}")
  file(
    WRITE "${SCRATCH}/include/a.hpp"
    [==[
    namespace some {
    /// A comment with a call(int).
    [[nodiscard]] constexpr float turned(float by, unsigned times = 2) noexcept { return hidden(by); }
    template <class T>
    void each(T take);
    class box {
     public:
      explicit box(int size) noexcept : size_(size) {}
      void fill(std::span<const point> points) noexcept;

     private:
      static int hidden(int size);
      int size_;
    };
    struct plain {
      [[nodiscard]] bool has(std::int64_t time_ns) const noexcept;
    };
    namespace detail {
    int inner(int size);
    }
    }  // namespace some
]==]
  )
  string(REPLACE "@" "" test "${test}")
  file(WRITE "${SCRATCH}/tests/a_test.cpp" "${test}")
  file(WRITE "${SCRATCH}/tests/left_out.txt" "# name: why\n${left_out}")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DHEADERS=${SCRATCH}/include" "-DTESTS=${SCRATCH}/tests" "-DAWK=${AWK}" -P "${SCRIPT}"
    RESULT_VARIABLE code ERROR_VARIABLE output
  )
  if(pattern STREQUAL "" AND code EQUAL 0)
    return()
  endif()
  if(pattern STREQUAL "" OR code EQUAL 0 OR NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "expected '${pattern}', not: ${output}")
  endif()
endfunction()

set(all "turned(1)@ b.fill(p)@ box(1)@ c.has(1)")
expect("" "${all}" "")
expect("a.hpp: turned is not called" "b.fill(p)@ box(1)@ c.has(1)" "")
expect("a.hpp: fill is not called" "turned(1)@ box(1)@ c.has(1)@ // fill" "")
expect("a.hpp: has is not called" "turned(1)@ box(1)@ fill(1)" "")
expect("a.hpp: box is not called" "turned(1)@ fill(1)@ c.has(1)" "")
expect("" "b.fill(p)@ box(1)@ c.has(1)" "turned: because\n")
expect("is not 'name: why'" "${all}" "turned\n")
expect("no function gone takes a number" "${all}" "gone: because\n")
expect("a test calls turned" "${all}" "turned: because\n")
