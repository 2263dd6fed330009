// Empty: compiles the common includes of all tests once (tests/CMakeLists.txt).
