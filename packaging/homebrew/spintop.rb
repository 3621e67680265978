# The formula of spintop for Homebrew on Linux: Formula/spintop.rb of a tap.
class Spintop < Formula
  desc "Motion of a heavy spinning top, exact and by many integrators"
  homepage "https://example.org/spintop"
  url "https://example.org/spintop/releases/download/v0.1.0/spintop-0.1.0.tar.gz"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license "MIT"

  depends_on "cmake" => :build
  depends_on "fpm" => :build
  depends_on "python@3.13" => :build
  depends_on "gcc"
  depends_on "lapack"
  depends_on :linux

  resource "sundials" do
    url "https://github.com/LLNL/sundials/releases/download/v7.1.1/sundials-7.1.1.tar.gz"
    sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  end

  resource "minpack" do
    url "https://github.com/fortran-lang/minpack/archive/refs/tags/v2.0.0-rc.1.tar.gz"
    sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  end

  def install
    %w[sundials minpack].each { |name| resource(name).stage(buildpath/name) }
    tools = buildpath/"tools"
    tools.mkpath
    %w[gcc g++ gfortran].each do |name|
      ln_s Formula["gcc"].opt_bin/"#{name}-#{Formula["gcc"].version.major}", tools/name
    end
    ENV.prepend_path "PATH", tools
    ENV.prepend_path "LIBRARY_PATH", Formula["lapack"].opt_lib
    ENV["SPINTOP_FPM"] = Formula["fpm"].opt_bin/"fpm"
    system "packaging/from_sources", "sundials", "minpack", prefix
  end

  test do
    (testpath/"top.nml").write <<~INPUT
      &study kind = 'trajectory' /
      &top mass = 1, inertia = 0.875, 0.875, 0.25, length = 0.866 /
      &initial theta_deg = 30, psi_rate = 10 /
      &span t_end = 1 /
    INPUT
    system bin/"spintop", "--quiet", "top.nml"
    assert_path_exists testpath/"output/top.csv"
  end
end
