# SPDX-License-Identifier: MIT
# cmake -DSCRIPT=<check_sizes.cmake> -DAWK=<awk> -DSCRATCH=<directory> -P check_sizes_test.cmake
#
# Test of the check itself: classes whose members were counted by hand, and files of known length.

cmake_minimum_required(VERSION 3.22)

set(most_functions 99)
set(most_function_lines 99)
function(expect members lines message) # <file> <text>...
  file(REMOVE_RECURSE "${SCRATCH}")
  file(WRITE "${SCRATCH}/tests/test.cpp" "")
  while(ARGN)
    list(POP_FRONT ARGN file text)
    string(REPLACE "|" ";" text "${text}")
    string(REPLACE "^" "[" text "${text}")
    string(REPLACE "~" "]" text "${text}")
    file(WRITE "${SCRATCH}/${file}" "${text}\n")
  endwhile()
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DROOT=${SCRATCH}" "-DAWK=${AWK}" -DMOST_MEMBERS=${members} -DMOST_LINES=${lines}
            -DMOST_FUNCTIONS=${most_functions} -DMOST_FUNCTION_LINES=${most_function_lines} -P "${SCRIPT}"
    OUTPUT_VARIABLE output ERROR_VARIABLE output
  )
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "${message}")
    message(FATAL_ERROR "expected '${message}', but:\n${output}")
  endif()
endfunction()

# counts(<number> <class x>): in the text, | is a semicolon, and ^ ~ are brackets.
function(counts number text)
  expect(${number} 99 "classes, each with at most" src/x.hpp "${text}")
  math(EXPR less "${number} - 1")
  expect(${less} 99 "src/x.hpp: x has ${number} data members" src/x.hpp "${text}")
endfunction()

counts(1 "class x { int a| }|")
counts(2 "struct x final {\n  int a = 3|  // int b|\n  /* int c|\n int d| */ int e{1}|\n}|")
counts(5 "class x {\n public:\n  int a, b = 2, *c{nullptr}|\n private:\n  std::array<int, 3> d{}| std::map<int, int> e|\n}|")
counts(3 "struct x { unsigned a : 3, b : 4| int c^2~^3~ = {{1, 2}, {3}}| }|")
counts(2 "struct x { void (*a)(int, int)| std::function<void(int, int)> b = ^~(int, int) { int c| }| }|")
counts(1 "template <class T, int N>\nclass x : public std::vector<T> {\n  alignas(64) std::atomic<T> a = T(1)|\n}|")
counts(1 "class ^^nodiscard~~ API x {\n  static int b| static constexpr int c = 1| using d = int| friend class e|\n  class f| enum class g : int { h, i }| typedef int j| int a|\n}|")
counts(2 "class x {\n  x() : a_(1), b_{2} {}\n  explicit x(int a) noexcept : b_{a}, a_{1} { int c| }\n  ~x()| x& operator=(const x&) = delete| bool operator()(int) const { return {}| }\n  auto f(int a = 1) -> std::pair<int, int> { struct y { int b, c| }| for (int i = 0| i < 3| ++i) {} }\n  virtual void g() = 0| operator bool() const { return a_ < b_| }\n  int a_| int b_{3}|\n}|")
counts(2 "class x {\n  struct inner { int a, b| }|\n  inner first| const char* second = \"|}{ // \"|\n}|" )
counts(3 "struct x {\n  struct { int a| int b| }|\n  union named { int d, e| } c|\n}|")
counts(1 "struct x { const char* a = R\"(int b| int c| })\"| }|\n")
counts(3 "struct base { int a| int b| }|\nnamespace n {\nclass x : private g4::base, public std::other { char c = '}'| }|\n}")
expect(3 99 "include/y.hpp: y has 4 data members" include/b.hpp "class b { int a, b| }|" tools/z.hpp
       "class z : b { int c| }|" include/y.hpp "class y final : public z { int d| }|"
)
expect(1 99 "src/x.cpp: inner has 2 data members" src/x.cpp "void f() {\n  struct inner { int a, b| }|\n}")
expect(3 99 "3 classes" src/x.hpp "class device_options { int a, b, c, d| }| struct y {}| class z { int e = 1'000| }|")

# functions(<number> <class x>): likewise, of functions besides constructors, destructor, defaulted and deleted ones.
function(functions number text)
  set(most_functions ${number})
  expect(9 99 "classes, each with at most" src/x.hpp "${text}")
  math(EXPR most_functions "${number} - 1")
  expect(9 99 "src/x.hpp: x has ${number} functions" src/x.hpp "${text}")
endfunction()
functions(1 "class x {\n  x()| explicit x(int a) : a_(a) {}\n  ~x()| x(const x&) = delete| x& operator=(const x&) = default|\n  int a() const { return a_| }\n  int a_ = f(3)|\n}|")
functions(4 "class x {\n  ^^nodiscard~~ bool operator()(int) const { return {}| }\n  template <class T>\n  void f(T&& use) { use()| }\n  friend void g(x)|\n  static int h()| virtual void i() = 0|\n  std::function<void(int)> j| void (*k)(int)| using l = int(int)|\n}|")
functions(2 "class x {\n  struct y { int a()| int b() { return 1| } }|\n  int a() {\n    struct z { int c() { return 2| } }|\n    return b()|\n  }\n  int b()|\n}|")
expect(3 3 "bench/long.cpp has more than 3 lines" src/x.hpp "1\n2\n3" bench/long.cpp "1\n2\n3\n4")
expect(3 3 "ros/x/test/long.py has more than 3 lines" src/x.hpp "1\n2\n3" ros/x/test/long.py "1\n2\n3\n4")
expect(1 99 "ros/x/src/x.hpp: x has 2 data members" src/y.hpp "1" ros/x/src/x.hpp "class x { int a, b| }|")
expect(3 4 "3 files of at most 4 lines" src/x.hpp "1\n2\n3" bench/long.cpp "1\n2\n3\n4")

# Functions of known length, of which the signature is a part; a class or a table is none.
set(most_function_lines 4)
expect(9 99 "python/src/x.cpp:2: a function of 5 lines" src/x.hpp "" python/src/x.cpp "namespace n {\nvoid f(int a,\n       int b) {\n  if (a) {\n  }\n}\n}")
expect(9 99 "ros/x/src/x.cpp:3: a function of 5 lines" src/x.hpp "" ros/x/src/x.cpp "class x {\n\n  x(int a)\n      : a_(a) {\n    f()|\n    g()|\n  }\n}|")
expect(9 99 "1 classes" src/x.hpp "class x {\n  int f(int a) {\n    for (|||) {\n    }\n  }\n}|\nconstexpr auto t = f({\n1,\n2,\n3,\n4})|\n")
