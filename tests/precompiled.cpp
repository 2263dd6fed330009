// Empty: with this, what all tests include is compiled once (tests/CMakeLists.txt).
