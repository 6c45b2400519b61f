
camera {
}
